#pragma once

#include <Eigen/Core>
#include <optional>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/polygon.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::compare {

/// A scene's polygon as a problem of the solver for rigid chains.
struct ChainScene {
  energy_model::Plane plane;           ///< plane of the polygon, in space
  energy_model::ChainProblem problem;  ///< in the coordinates of the plane

  /// Returns points of the plane [m], 2 x M, as points in space [m], 3 x M.
  [[nodiscard]] Eigen::Matrix3Xd to_space(const Eigen::Matrix2Xd& points) const;
};

/// Returns the rigid chain of a scene's polygon, std::nullopt unless the scene has one clamp at an
/// end, forces in one plane and no obstacle in reach.
[[nodiscard]] std::optional<ChainScene> chain_scene(const Scene& scene,
                                                    const Discretisation& discretisation,
                                                    const ForceModelSettings& settings);

/// Returns a polygon as a problem of the solver for elastic polygons, which takes every scene.
/// @param joint_law  replaces the law hooke of the rod (ForceModelSettings::joint_law); the law
/// paper is kept
[[nodiscard]] energy_model::PolygonProblem polygon_problem(
    const force_model::Rod& rod, std::optional<energy_model::JointLaw> joint_law = std::nullopt);

/// Returns the scene as a problem of the energy model.
/// @throws InputError naming file, line and key if two grippers hold one arc length, or are at
/// least as far apart as the length of the rod between them, unless the scene counts stretch or
/// its rod is a taut line
[[nodiscard]] energy_model::Problem energy_problem(const Scene& scene);

}  // namespace dlo::compare
