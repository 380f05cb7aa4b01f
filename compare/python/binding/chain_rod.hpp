#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "bind_scene.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/force_model/batch.hpp"

namespace dlo::python {

/// Force model of a scene, for the user's loop.
struct ChainRod {
  force_model::BatchRod start;  ///< contains all obstacles, since they may be moved into reach
  compare::Discretisation discretisation;
};

/// Makes the force model of a scene.
/// @param points  initial points [m], 3 x N; empty: straight from one gripper, between several the
/// rest shape of the polygon
/// @param grip_stiffness  stiffness of springs that hold the points instead of rigid grips [N/m];
/// empty: rigid
/// @throws compare::InputError, also for a scene that the loop does not support
[[nodiscard]] ChainRod chain_rod(const SceneData& data,
                                 const std::optional<Eigen::Matrix3Xd>& points,
                                 std::optional<double> grip_stiffness);

/// Returns the targets of a grip after its gripper has moved. @param direction  empty: unchanged
/// @throws compare::InputError if there is no such gripper, a pin gets a direction, or it is zero
[[nodiscard]] Eigen::Matrix3Xd moved_targets(const force_model::Rod& rod, std::size_t gripper,
                                             const Eigen::Vector3d& position,
                                             const std::optional<Eigen::Vector3d>& direction);

/// Wall of a scene's obstacle after a movement.
struct MovedWall {
  std::size_t index = 0;  ///< index in Rod::walls
  force_model::Wall wall;
};
/// Returns the wall of a plane that has moved. @param point  point of the plane in the scene [m]
/// @param normal  to the free side, of any length
/// @throws compare::InputError if the obstacle is no plane, or the normal is zero
[[nodiscard]] MovedWall moved_wall(const SceneData& data, const ChainRod& rod, std::size_t obstacle,
                                   const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace dlo::python
