#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// Component across a plane, divided by the largest size, up to which vectors lie in the plane.
inline constexpr double planar_tolerance = 1e-12;

/// A right-handed frame of a plane in space.
struct Plane {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< point of the plane [m]
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();      ///< unit vector
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();      ///< unit vector, orthogonal to x

  /// Returns the components of a direction along x and y.
  [[nodiscard]] Eigen::Vector2d coordinates(const Eigen::Vector3d& vector) const {
    return {x.dot(vector), y.dot(vector)};
  }
  /// Returns the unit normal, x cross y.
  [[nodiscard]] Eigen::Vector3d normal() const { return x.cross(y); }
};

/// Finds the plane that contains the direction of a rod at `origin` and all forces. If all are
/// parallel, any plane through them would do; the one towards global +x is returned (+y for a rod
/// along x), which also determines to which side an upright rod buckles.
/// @return std::nullopt if a force has a component across the plane of more than planar_tolerance
/// times the largest one
[[nodiscard]] std::optional<Plane> find_plane(const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction,
                                              const std::vector<Eigen::Vector3d>& forces);

}  // namespace dlo::energy_model
