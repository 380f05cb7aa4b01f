#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

struct TrustRegion {
  double radius = 1;
  /// Norm up to which the gradient is zero: only a direction of negative curvature leads on.
  double gradient_tolerance = 0;
  /// Newton's step up to which a point is next to a minimum.
  double least_step = 0;
};

/// The trust-region subproblem: the step p of the free directions that lowers
///     g.p + p.H p / 2
/// most in |p| <= radius (Moré and Sorensen, Computing a Trust Region Step, 1983):
///     (H + mu) p = -g,  mu >= 0,  H + mu positive semidefinite,
/// with mu = 0 or, to between 0.75 and 1.01 of it, |p| = radius. Where the gradient has no part
/// along the smallest eigenvalue (the hard case) p goes on along that to the region's edge.
/// @return nothing next to a minimum: there all eigenvalues are above -neutral
[[nodiscard]] std::optional<Eigen::VectorXd> trust_region_step(ReducedHessian& hessian,
                                                               const Eigen::VectorXd& gradient,
                                                               const TrustRegion& region);

}  // namespace dlo::energy_model
