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

/// Shape and energies of a polygon, and what obstacles do to it. Points that a gripper holds do not
/// touch them: a clamp near an obstacle may hold its inner point behind it.
/// @param rod  the discretisation's, with frames where there is twist
[[nodiscard]] Solution polygon_solution(const Scene& scene, const ForceModelSettings& settings,
                                        const Discretisation& discretisation,
                                        const force_model::Rod& rod,
                                        const Eigen::Matrix3Xd& points);

/// What the grippers exert on a polygon, in the scene's order. What an obstacle does to a held
/// point inside a gripper is not felt outside.
[[nodiscard]] std::vector<GripperLoad> gripper_loads(force_model::Rod rod,
                                                     const Eigen::Matrix3Xd& points);

/// What acts on a polygon leaves: what the grippers exert, the loads, and obstacles on points that
/// no gripper holds.
[[nodiscard]] energy_model::Imbalance polygon_imbalance(const force_model::Rod& rod,
                                                        const Eigen::Matrix3Xd& points,
                                                        const std::vector<GripperLoad>& grippers);

/// Returns the largest Imbalance::share() of a polygon that has not come to rest: the sum of what
/// the step to rest changes of each force and moment on the polygon, besides allowed_imbalance. The
/// forces balance after the step, so their sum before it cannot be larger.
/// @param to_rest  Newton's step from each point [m]
[[nodiscard]] double allowed_rest_imbalance(const force_model::Rod& rod,
                                            const Eigen::Matrix3Xd& points,
                                            const Eigen::Matrix3Xd& to_rest);

/// Returns what the grippers exert on a polygon if the polygon is an equilibrium with it.
/// @param grippers  in the order of the rod's grips
/// @param allowed   largest polygon_imbalance().share()
/// @param model     of the message
/// @throws ConvergenceError if the forces and moments on the polygon do not balance
[[nodiscard]] std::vector<GripperLoad> balanced(const Scene& scene, const force_model::Rod& rod,
                                                const Eigen::Matrix3Xd& points,
                                                std::vector<GripperLoad> grippers, double allowed,
                                                const char* model);

/// A polygon that had to stretch or to shrink is no shape of the rod, however well it balances.
/// @throws ConvergenceError then, with the number of points that may do
void require_unstrained(const Scene& scene, const ForceModelSettings& settings,
                        const Discretisation& discretisation, const Eigen::Matrix3Xd& points,
                        const char* model);

/// The lowest of the shapes that a polygon's starts lead to, and of one that clamps twist the shape
/// to which the twist leads from there.
struct LowestPolygon {
  std::size_t start = 0;  ///< of Discretisation::starts
  energy_model::PolygonResult result;
  /// The discretisation's; where the scene's clamps twist it with their frames and its twist.
  force_model::Rod rod;
  Eigen::Matrix3Xd untwisted;  ///< where it rests without twist [m]; of others 3 x 0
  int evaluations = 0;         ///< of all starts
  double seconds = 0;
};

/// @throws ConvergenceError, of a strained polygon too
[[nodiscard]] LowestPolygon lowest_polygon(const Scene& scene, const ForceModelSettings& settings,
                                           const Discretisation& discretisation,
                                           const SolveOptions& options);

}  // namespace dlo::compare
