#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Whether a polygon models the rod's intrinsic curvature by joints with rest angles. It does with
/// the law hooke and in a plane; in space it would need the rod's frame, which points do not have.
[[nodiscard]] bool models_natural_curvature(const Scene& scene, const ForceModelSettings& settings);

/// Whether a polygon models the twist that the scene's clamps hold. It does with the law hooke, for
/// an intrinsically straight rod.
[[nodiscard]] bool models_twist(const Scene& scene, const ForceModelSettings& settings);

/// Returns the properties of the scene that its polygon neglects: "twist", "natural curvature",
/// both or none.
[[nodiscard]] std::vector<std::string> neglected_by_polygon(const Scene& scene,
                                                            const ForceModelSettings& settings);

/// Returns the scene without the properties that its polygon neglects (neglected_by_polygon).
[[nodiscard]] Scene without_neglected_properties(const Scene& scene,
                                                 const ForceModelSettings& settings);

/// A rotation and a translation that move a planar scene into the plane z = 0, in which joints with
/// rest angles are defined.
class PlaneTransform {
 public:
  /// @param normal  normal of the scene's plane, becomes +z
  /// @param origin  a point of the plane [m]
  PlaneTransform(const Eigen::Vector3d& normal, Eigen::Vector3d origin);

  /// Returns the scene moved into the plane z = 0; rounding errors out of the plane are set to
  /// zero.
  [[nodiscard]] Scene transformed(const Scene& scene) const;
  [[nodiscard]] Eigen::Matrix3Xd transformed_points(const Eigen::Matrix3Xd& points) const;

  [[nodiscard]] Eigen::Matrix3Xd points_to_space(const Eigen::Matrix3Xd& points) const {
    return vectors_to_space(points).colwise() + origin_;
  }
  [[nodiscard]] Eigen::Matrix3Xd vectors_to_space(const Eigen::Matrix3Xd& vectors) const {
    return turn_.transpose() * vectors;
  }

 private:
  [[nodiscard]] Eigen::Vector3d flat(const Eigen::Vector3d& vector) const;

  Eigen::Matrix3d turn_;
  Eigen::Vector3d origin_;
};

/// Returns the rotation that a scene needs before it is discretised, std::nullopt if it needs none.
[[nodiscard]] std::optional<PlaneTransform> plane_transform(const Scene& scene,
                                                            const ForceModelSettings& settings);

}  // namespace dlo::compare
