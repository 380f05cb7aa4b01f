#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Largest Imbalance::share() with which a shape is accepted as an equilibrium [-].
inline constexpr double allowed_imbalance = 1e-8;

/// A force and a couple on a rod.
struct Action {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< point at which the force acts [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  /// Couple in addition to the moment of the force [N m].
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();

  /// Returns the couple plus the moment of the force about `origin` [N m].
  [[nodiscard]] Eigen::Vector3d moment_about(const Eigen::Vector3d& origin) const;
};

/// Sums of the forces and moments of all actions on a rod. Both are zero at equilibrium.
struct Imbalance {
  double force = 0;          ///< size of the sum of all forces [N]
  double moment = 0;         ///< size of the sum of all moments about the first point [N m]
  double largest_force = 0;  ///< largest force of a single action [N]
  /// Larger of the largest couple and of the largest force times the largest distance from the
  /// first point [N m].
  double largest_moment = 0;

  /// Returns force / largest_force or moment / largest_moment, whichever is larger [-]; NaN if
  /// either is NaN, as it is if an action contains NaN, largest_force is 0 or largest_moment is 0.
  [[nodiscard]] double share() const;
  /// Returns a text with both sums and their shares of the largest force and moment.
  [[nodiscard]] std::string text() const;
};

/// Sums forces and moments of actions, the moments about the point of the first action.
/// @param least  lower bounds of Imbalance::largest_force [N] and of the largest couple [N m]. The
///               solver rounds on that scale, so smaller actions do not make the share larger
[[nodiscard]] Imbalance imbalance_of(const std::vector<Action>& actions, const Action& least);

/// Sums the actions on the rod in a shape that a solver has returned: reactions at the positions of
/// the grips; weight, loads, line loads, drag and obstacles at their positions in the shape. The
/// action of a rigid obstacle is taken from Equilibrium::contacts, and that of a yielding obstacle
/// is computed from its depth in the shape. If the force of an obstacle differs from
/// Equilibrium::obstacles by more than Imbalance::force, that difference replaces it.
/// @param shape  equilibrium with `sample` and a reaction for each grip
[[nodiscard]] Imbalance imbalance_of(const Problem& problem, const Equilibrium& shape);

/// Sets the status of an equilibrium to not_verified if its Imbalance::share() is larger than
/// `allowed` or NaN, and then writes both sums into its message. Checks results that are
/// `converged`, `roundoff_limited` or `saddle`, and `not_verified` ones whose loads have no
/// potential. Others are unchanged, and so are results that cannot be sampled.
void judge_balance(const Problem& problem, Equilibrium& equilibrium,
                   double allowed = allowed_imbalance);

}  // namespace dlo::energy_model
