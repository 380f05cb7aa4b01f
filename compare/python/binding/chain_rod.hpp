#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "bind_scene.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/force_model/batch.hpp"

namespace dlo::python {

/// A scene's force model as its loop needs it.
struct ChainRod {
  force_model::BatchRod start;  ///< with all obstacles, for they may be moved into reach
  compare::Discretisation discretisation;
};

/// @param points  where it starts [m], 3 x N; none: straight from one gripper, between several
/// where its polygon rests
/// @param grip_stiffness  of springs that hold the points instead of rigid grips [N/m]; none: rigid
/// @throws compare::InputError, also of a scene that this loop does not know
[[nodiscard]] ChainRod chain_rod(const SceneData& data,
                                 const std::optional<Eigen::Matrix3Xd>& points,
                                 std::optional<double> grip_stiffness);

/// Where a grip's points go when its gripper moves. @param direction  none: as it is
/// @throws compare::InputError if there is no such gripper or direction
[[nodiscard]] Eigen::Matrix3Xd moved_targets(const force_model::Rod& rod, std::size_t gripper,
                                             const Eigen::Vector3d& position,
                                             const std::optional<Eigen::Vector3d>& direction);

/// The wall of a scene's obstacle, moved. @param discretisation  of chain_rod()
/// @throws compare::InputError if it is no plane
struct MovedWall {
  std::size_t index = 0;  ///< of Rod::walls
  force_model::Wall wall;
};
[[nodiscard]] MovedWall moved_wall(const SceneData& data, const ChainRod& rod, std::size_t obstacle,
                                   const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace dlo::python
