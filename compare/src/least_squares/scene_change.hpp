#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// The ways in which something may be off: in a plane with this normal, or every way. Columns,
/// unit and orthogonal.
/// @param normal  unit; none: every way
[[nodiscard]] Eigen::Matrix3Xd ways_across(const Eigen::Vector3d& direction,
                                           const std::optional<Eigen::Vector3d>& normal);
[[nodiscard]] Eigen::Matrix3Xd ways_of_place(const std::optional<Eigen::Vector3d>& normal);

/// Turns a clamp's direction about an axis across it, and the frame that it holds with it.
/// @param turn  rotation vector [rad]
void turn_clamp(Gripper& clamp, const Eigen::Vector3d& turn);

/// Whether there are no loads, streams, obstacles or grippers that move.
[[nodiscard]] bool is_bent_by_weight_alone(const Scene& scene);

/// Turns a scene as a whole, about its first gripper: grippers and gravity. So it lies in the
/// coordinates of a camera that is not level.
/// @param scene  is_bent_by_weight_alone();  @param turn  rotation vector [rad]
void turn_scene(Scene& scene, const Eigen::Vector3d& turn);

/// Adds to the natural curvature about d1 and d2 [1/m].
/// @param term  0: to its mean; k: to its coefficient of Legendre's P_k of 2 s/l - 1
void bend_by_nature(Scene& scene, std::size_t term, const Eigen::Vector2d& curvature);

}  // namespace dlo::compare
