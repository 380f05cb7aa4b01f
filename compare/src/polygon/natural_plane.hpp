#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Whether a polygon's joints are bent at rest as the scene's rod is intrinsically curved: with the
/// law hooke and in a plane. In space they would need the rod's frame, which points have not.
[[nodiscard]] bool takes_natural_curvature(const Scene& scene, const ForceModelSettings& settings);

/// Whether a polygon has the twist that the scene's clamps hold: with the law hooke, of a rod that
/// is intrinsically straight.
[[nodiscard]] bool takes_twist(const Scene& scene, const ForceModelSettings& settings);

/// What polygons neglect of what the scene has: "twist", "natural curvature", or nothing.
[[nodiscard]] std::vector<std::string> neglected_by_polygon(const Scene& scene,
                                                            const ForceModelSettings& settings);

/// The scene without that.
[[nodiscard]] Scene as_polygons_take_it(const Scene& scene, const ForceModelSettings& settings);

/// A turn and a shift that lay a plane scene into the plane z = 0, where joints that are bent at
/// rest belong.
class PlaneTurn {
 public:
  /// @param normal  of the scene's plane, becomes +z;  @param origin  a point of it [m]
  PlaneTurn(const Eigen::Vector3d& normal, Eigen::Vector3d origin);

  /// The scene in the plane; what rounding has left across it is gone.
  [[nodiscard]] Scene laid(const Scene& scene) const;
  [[nodiscard]] Eigen::Matrix3Xd laid_points(const Eigen::Matrix3Xd& points) const;

  [[nodiscard]] Eigen::Matrix3Xd points_back(const Eigen::Matrix3Xd& points) const {
    return vectors_back(points).colwise() + origin_;
  }
  [[nodiscard]] Eigen::Matrix3Xd vectors_back(const Eigen::Matrix3Xd& vectors) const {
    return turn_.transpose() * vectors;
  }

 private:
  [[nodiscard]] Eigen::Vector3d flat(const Eigen::Vector3d& vector) const;

  Eigen::Matrix3d turn_;
  Eigen::Vector3d origin_;
};

/// The turn that a scene needs before it is made a polygon; nothing if it needs none.
[[nodiscard]] std::optional<PlaneTurn> turn_into_plane(const Scene& scene,
                                                       const ForceModelSettings& settings);

}  // namespace dlo::compare
