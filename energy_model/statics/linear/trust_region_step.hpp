#pragma once

#include <Eigen/Core>
#include <optional>

#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {

struct TrustRegion {
  double radius = 1;
  /// Norm up to which the gradient counts as zero: only negative curvature then gives a step.
  double gradient_tolerance = 0;
  /// Length of Newton's step up to which the point counts as a minimum.
  double least_step = 0;
};

/// Solves the trust-region subproblem: finds the step p of the free directions that minimises
///     g.p + p.H p / 2
/// in |p| <= radius (Moré and Sorensen, Computing a Trust Region Step, 1983):
///     (H + mu) p = -g,  mu >= 0,  H + mu positive semidefinite,
/// with mu = 0 or |p| between 0.75 and 1.01 of the radius. If the gradient has no component along
/// the eigenvector of the smallest eigenvalue (the hard case), p is extended along that eigenvector
/// to the radius.
/// @return std::nullopt near a minimum, where all eigenvalues are above -neutral
[[nodiscard]] std::optional<Eigen::VectorXd> trust_region_step(ReducedHessian& hessian,
                                                               const Eigen::VectorXd& gradient,
                                                               const TrustRegion& region);

}  // namespace dlo::energy_model
