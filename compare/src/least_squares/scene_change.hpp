#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Returns the axes about which a direction may rotate (rotation_axes), or the directions of
/// possible displacements (translation_directions), within the plane with this normal or in space.
/// Columns, unit and orthogonal.
/// @param normal  unit; empty: in space
[[nodiscard]] Eigen::Matrix3Xd rotation_axes(const Eigen::Vector3d& direction,
                                             const std::optional<Eigen::Vector3d>& normal);
[[nodiscard]] Eigen::Matrix3Xd translation_directions(const std::optional<Eigen::Vector3d>& normal);

/// Rotates a clamp's direction and, if it is given, d1 of the frame that the clamp holds.
/// @param turn  rotation vector [rad]
void rotate_clamp(Gripper& clamp, const Eigen::Vector3d& turn);

/// Whether the rod has weight and there are no loads, drag, obstacles or moving grippers.
[[nodiscard]] bool is_bent_by_weight_alone(const Scene& scene);

/// Rotates a scene as a whole, grippers and gravity, about its first gripper. The result is the
/// scene in the coordinates of a camera that is not level.
/// @param scene  is_bent_by_weight_alone();  @param turn  rotation vector [rad]
void rotate_scene(Scene& scene, const Eigen::Vector3d& turn);

/// Adds to the natural curvature about d1 and d2 [1/m].
/// @param term  0: adds to the mean; k: to the coefficient of Legendre's P_k of 2 s/l - 1
void increase_natural_curvature(Scene& scene, std::size_t term, const Eigen::Vector2d& curvature);

}  // namespace dlo::compare
