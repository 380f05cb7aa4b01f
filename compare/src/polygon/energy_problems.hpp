#pragma once

#include <Eigen/Core>
#include <optional>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// The same polygon for the rigid chain solver.
struct ChainScene {
  energy_model::ChainProblem problem;  ///< in the coordinates of its plane
  Eigen::Vector3d origin;              ///< of the plane's frame, in space [m]
  Eigen::Vector3d x;                   ///< its axis, unit
  Eigen::Vector3d y;                   ///< its axis, unit

  /// Points of the plane [m], 2 x M, in space [m], 3 x M.
  [[nodiscard]] Eigen::Matrix3Xd to_space(const Eigen::Matrix2Xd& points) const;
};

/// Nothing unless the scene has one clamp at an end, forces in one plane and no obstacle.
[[nodiscard]] std::optional<ChainScene> chain_scene(const Scene& scene,
                                                    const Discretisation& discretisation,
                                                    const ForceModelSettings& settings);

/// The same polygon for the solver of elastic ones, which takes every scene.
/// @param joint_law  in place of the rod's own (ForceModelSettings::joint_law)
[[nodiscard]] energy_model::PolygonProblem polygon_problem(
    const force_model::Rod& rod, std::optional<energy_model::JointLaw> joint_law = std::nullopt);

/// The scene as the energy model sees it. @throws InputError naming file, line and key if two
/// grippers hold one arc length, or are no less apart than the rod between them
[[nodiscard]] energy_model::Problem energy_problem(const Scene& scene);

}  // namespace dlo::compare
