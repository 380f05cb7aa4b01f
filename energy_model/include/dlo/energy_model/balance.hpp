#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Imbalance (Imbalance::share()) up to which a shape is called an equilibrium [-].
inline constexpr double allowed_imbalance = 1e-8;

/// A force and a couple on a rod.
struct Action {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< at which the force acts [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();  ///< besides the moment of the force [N m]

  /// Returns the couple and the moment of the force about a point [N m].
  [[nodiscard]] Eigen::Vector3d moment_about(const Eigen::Vector3d& origin) const;
};

/// What all actions on a rod leave, which is zero at rest.
struct Imbalance {
  double force = 0;           ///< size of the sum of all forces [N]
  double moment = 0;          ///< size of the sum of all moments about the first point [N m]
  double largest_force = 0;   ///< of the actions [N]
  double largest_moment = 0;  ///< largest couple or force times distance, of the actions [N m]

  /// force / largest_force or moment / largest_moment, whichever is larger [-]; NaN if one of the
  /// actions is.
  [[nodiscard]] double share() const;
  /// Both sums with their shares, in words.
  [[nodiscard]] std::string text() const;
};

/// Sums actions.
/// @param least  the largest force [N] and moment [N m] are not taken as less, since the solver
///               rounds on that scale
[[nodiscard]] Imbalance imbalance_of(const std::vector<Action>& actions, const Action& least);

/// Sums what acts on the rod in a shape that a solver has returned: reactions of the grips, weight,
/// loads, line loads, drag and obstacles, each where the returned shape has it. A rigid obstacle
/// exerts what Equilibrium::contacts state; what one that yields exerts follows from its depth in
/// the shape. A difference from Equilibrium::obstacles counts as a force that is left.
/// @param shape  with `sample` and a reaction for each grip
[[nodiscard]] Imbalance imbalance_of(const Problem& problem, const Equilibrium& shape);

/// Marks an equilibrium whose imbalance is larger than allowed as not_verified, with both sums in
/// its message. Leaves alone what claims to be no equilibrium.
void judge_balance(const Problem& problem, Equilibrium& equilibrium,
                   double allowed = allowed_imbalance);

}  // namespace dlo::energy_model
