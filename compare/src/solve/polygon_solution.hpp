#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/balance.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::compare {

/// Returns shape and energies of a polygon and the forces of obstacles on it. Points that a gripper
/// holds are excluded from contact, because a clamp near an obstacle may hold its inner point
/// behind the surface.
/// @param rod  rod of the discretisation, with frames if there is twist
[[nodiscard]] Solution polygon_solution(const Scene& scene, const ForceModelSettings& settings,
                                        const Discretisation& discretisation,
                                        const force_model::Rod& rod,
                                        const Eigen::Matrix3Xd& points);

/// Returns forces and torques of the grippers on a polygon, in the scene's order. The force of an
/// obstacle on a held point inside a gripper is not included.
[[nodiscard]] std::vector<GripperLoad> gripper_loads(force_model::Rod rod,
                                                     const Eigen::Matrix3Xd& points);

/// Returns the imbalance of the actions on a polygon: those of the grippers, the loads, and forces
/// of obstacles on points that no gripper holds.
[[nodiscard]] energy_model::Imbalance polygon_imbalance(const force_model::Rod& rod,
                                                        const Eigen::Matrix3Xd& points,
                                                        const std::vector<GripperLoad>& grippers);

/// Returns the largest Imbalance::share() that is allowed for a polygon that has not come to rest.
/// It is allowed_imbalance plus the changes of all forces, or all moments, by the step to rest,
/// divided by the largest one. The forces balance after the step, so their sum before it cannot be
/// larger.
/// @param to_rest  Newton's step from each point [m]
[[nodiscard]] double allowed_rest_imbalance(const force_model::Rod& rod,
                                            const Eigen::Matrix3Xd& points,
                                            const Eigen::Matrix3Xd& to_rest);

/// Forces of the grippers with which a polygon is in equilibrium.
struct BalancedGrippers {
  std::vector<GripperLoad> loads;  // in the order of the rod's grips
  double share = 0;                // polygon_imbalance().share()
};

/// Checks that a polygon is in equilibrium under its actions, and returns those of the grippers.
/// @param grippers  in the order of the rod's grips
/// @param allowed   largest polygon_imbalance().share()
/// @param model     name of the model in the message
/// @throws ConvergenceError if the forces and moments on the polygon do not balance
[[nodiscard]] BalancedGrippers balanced(const Scene& scene, const force_model::Rod& rod,
                                        const Eigen::Matrix3Xd& points,
                                        std::vector<GripperLoad> grippers, double allowed,
                                        const char* model);

/// Checks that no segment of a polygon is strained by more than largest_strain(): a polygon that
/// had to stretch or shorten is no shape of the rod, even if it balances.
/// @throws ConvergenceError with the number of points, of which more may help
void require_unstrained(const Scene& scene, const ForceModelSettings& settings,
                        const Discretisation& discretisation, const Eigen::Matrix3Xd& points,
                        const char* model);

/// The lowest of the polygon's equilibria found from its starts. If clamps twist the rod, the
/// equilibrium to which the continuation of the twist leads from there.
struct LowestPolygon {
  std::size_t start = 0;  ///< index into Discretisation::starts
  energy_model::PolygonResult result;
  /// Rod of the discretisation; if the scene's clamps twist it, with their frames and the twist.
  force_model::Rod rod;
  Eigen::Matrix3Xd untwisted;  ///< shape at rest without twist [m]; 3 x 0 if nothing twists it
  int evaluations = 0;         ///< sum over all starts, and of the continuation of the twist
  double seconds = 0;
};

/// Finds the lowest polygon. @throws ConvergenceError, also for a strained polygon
[[nodiscard]] LowestPolygon lowest_polygon(const Scene& scene, const ForceModelSettings& settings,
                                           const Discretisation& discretisation,
                                           const SolveOptions& options);

}  // namespace dlo::compare
