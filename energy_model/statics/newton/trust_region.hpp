#pragma once

#include <Eigen/Core>

#include "base/deadline.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Trust-region radius in the unknowns: of the first step of a descent, and the largest one.
inline constexpr double first_radius = 1;
inline constexpr double largest_radius = 8;

struct TrustRegionOptions {
  double load = 0;  ///< weight plus loads, the scale of the gradient
  /// Tolerance of the projected gradient, divided by 1 + load; > 0.
  double gradient_tolerance = 0;
  /// Length of Newton's step up to which a minimum is close enough for Newton's method; used if the
  /// projected Hessian is positive definite.
  double nearest = 0;
  double radius = first_radius;        ///< radius of the first step, in the unknowns; > 0
  int max_iterations = 100;            ///< maximum number of steps, accepted or not
  const Deadline* deadline = nullptr;  ///< checked once per step; null: none
  /// Largest stiffness of a taut segment between grips [EI/l^3]; used by
  /// descend_by_augmented_lagrangian() only.
  double stiffness = 0;
};

/// Descends from solution.x to a point near a minimum of the energy under the constraints: Newton's
/// method in the null space of their Jacobian J, within a trust region,
///     min g.p + p.H p / 2,  |p| <= radius,  J p = 0.
/// g and H belong to E - lambda.c, with the least-squares multipliers lambda. Each step is followed
/// by Gauss-Newton steps that restore c = 0, to min(1e-5, |p|^2 / 100): a larger residual would
/// spoil the comparison of energies. A step is accepted if it decreases E - lambda.c by at least a
/// tenth of the prediction. A negative eigenvalue of H is followed to the region's boundary (Moré
/// and Sorensen), so that the descent does not end on a saddle even from a symmetric start.
///
/// Status `converged` means that the projected gradient is below its tolerance and H has no
/// eigenvalue below -neutral, or that a minimum is within `nearest`. The multipliers are stored in
/// the solution.
void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options);

}  // namespace dlo::energy_model
