#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>
#include <optional>

#include "base/deadline.hpp"
#include "linear/reduced_hessian.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Gradient norm, divided by 1 + load, at which a descent ends and Newton's method takes over: two
/// Newton steps square it to below rounding, while a line search, which compares energies, would
/// stall near the root of the rounding error.
inline constexpr double handover_gradient = 1e-5;

/// Constraint residual from which a descent starts, and the largest one that it leaves between
/// steps.
inline constexpr double largest_constraint_residual = 1e-5;

/// Buffers of restore_constraints(), kept from one call to the next.
struct RestoreScratch {
  SpanPoint trial;
  Eigen::MatrixXd square, normal;
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd along, step;
};

/// Reduces the constraint residual to |c| <= gap by steps that each have to decrease it:
/// Levenberg-Marquardt steps, which become Gauss-Newton steps near the end,
///     -J^T (J J^T + mu)^-1 c.
/// @param[in,out] point  evaluated
/// @param most_energy    energy above which the search is abandoned
/// @return whether the residual was reduced to `gap`; without constraints, whether the energy is
///   finite
[[nodiscard]] bool restore_constraints(
    SpanSolution& solution, SpanPoint& point, double gap, RestoreScratch& scratch,
    double most_energy = std::numeric_limits<double>::infinity());

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
/// @return std::nullopt if no direction is free, and near a minimum: if H is positive definite and
///   Newton's step is at most `least_step`, or if the gradient counts as zero and all eigenvalues
///   are above -`zero_eigenvalue_limit`
[[nodiscard]] std::optional<Eigen::VectorXd> trust_region_step(ReducedHessian& hessian,
                                                               const Eigen::VectorXd& gradient,
                                                               const TrustRegion& region);

/// Trust-region radius in the unknowns: of the first step of a descent, and the largest one.
inline constexpr double first_radius = 1;
inline constexpr double largest_radius = 8;

struct TrustRegionOptions {
  /// Length of Newton's step up to which a minimum is close enough for Newton's method; used if the
  /// projected Hessian is positive definite. This and `radius` are used by
  /// descend_in_trust_region() only.
  double nearest = 0;
  double radius = first_radius;  ///< radius of the first step, in the unknowns; > 0
  Deadline deadline{};           ///< checked once per step
  /// Largest stiffness of a taut segment between grips [EI/l^3]; used by
  /// descend_by_augmented_lagrangian() only.
  double stiffness = 0;
};

/// Descends from solution.x to a point near a minimum of the energy under the constraints: Newton's
/// method in the null space of their Jacobian J, within a trust region,
///     min g.p + p.H p / 2,  |p| <= radius,  J p = 0.
/// g and H belong to E - lambda.c, with the least-squares multipliers lambda. Each step is followed
/// by Gauss-Newton steps that restore c = 0, to min(1e-5, |p|^2 / 100), but at least 1e-13: a
/// larger residual would spoil the comparison of energies. A step is accepted if it decreases E -
/// lambda.c by at least a tenth of the prediction. A negative eigenvalue of H is followed to the
/// region's boundary (Moré and Sorensen), so that the descent does not end on a saddle even from a
/// symmetric start.
///
/// Status `converged` means that the projected gradient is at most `handover_gradient` times 1 +
/// load and H has no eigenvalue below -`zero_eigenvalue_limit`, or that a minimum is within
/// `nearest`, or that no direction is free. If the steps or the radius have ended before, the
/// status is `roundoff_limited`. If c = 0 cannot be restored at the start, it is `failed` and x is
/// kept. The multipliers are stored in the solution.
void descend_in_trust_region(SpanSolution& solution, const TrustRegionOptions& options);

/// Descends from solution.x to a point near a minimum of the energy under the constraints c = 0,
/// which need not hold at intermediate points. The method of multipliers minimises
///     E - mu.c + kappa |c|^2 / 2
/// repeatedly, with mu -> mu - kappa c and a growing kappa, each time by Newton's method in a trust
/// region (Moré and Sorensen). If grips stretch a rod nearly to its length, few shapes satisfy the
/// constraints, all of them close to straight. Restoring c = 0 from another shape fails there;
/// penalty springs that become stiffer do not.
///
/// Status `converged` means that |c| is small enough for Newton's method, after a minimisation that
/// ended at a small gradient or at its smallest radius.
void descend_by_augmented_lagrangian(SpanSolution& solution, const TrustRegionOptions& options);

}  // namespace dlo::energy_model
