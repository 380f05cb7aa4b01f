#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Of the region in the unknowns: where a descent begins, and the most that it grows to.
inline constexpr double first_radius = 1;
inline constexpr double largest_radius = 8;

struct TrustRegionOptions {
  double load = 0;                ///< sum of weight and loads, the scale of the gradient
  double gradient_tolerance = 0;  ///< of the projected gradient, over 1 + load; > 0
  /// Newton's step up to which a minimum is near enough for Newton's method, where the projected
  /// Hessian is positive definite.
  double nearest = 0;
  double radius = first_radius;        ///< of the first step, in the unknowns; > 0
  int max_iterations = 100;            ///< steps, accepted or not
  const Deadline* deadline = nullptr;  ///< asked once a step; null: none
  double stiffness = 0;                ///< of the rod between its grips, force per length
};

/// Descends from solution.x to a point near a minimum of the energy under the constraints: Newton's
/// method in the null space of their Jacobian J, within a trust region,
///     min g.p + p.H p / 2,  |p| <= radius,  J p = 0,
/// g and H of E - lambda.c with the multipliers lambda that balance the gradient best (least
/// squares). Each step is followed by Gauss-Newton steps that restore c = 0, to min(1e-5, |p|^2 /
/// 100): a gap that is larger spoils the comparison of the energies. A step is kept if it lowers E
/// - lambda.c by a tenth of what was predicted. A negative eigenvalue of H is followed to the
/// region's edge (Moré and Sorensen), so that it does not end on a saddle, however symmetric its
/// start.
///
/// Status `converged` says that the projected gradient is below its tolerance where H has no
/// eigenvalue below -neutral, or that a minimum is as near as was asked for; the multipliers are
/// left in the solution.
void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options);

}  // namespace dlo::energy_model
