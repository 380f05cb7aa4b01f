#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// A right-handed frame of a plane in space.
struct Plane {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< a point of it [m]
  Eigen::Vector3d x = Eigen::Vector3d::UnitX();      ///< unit
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();      ///< unit, orthogonal to x

  /// Of a direction, along x and y.
  [[nodiscard]] Eigen::Vector2d coordinates(const Eigen::Vector3d& vector) const {
    return {x.dot(vector), y.dot(vector)};
  }
  /// A direction in space.
  [[nodiscard]] Eigen::Vector3d vector(const Eigen::Vector2d& coordinates) const {
    return x * coordinates.x() + y * coordinates.y();
  }
};

/// The plane of a rod that leaves `origin` along `direction` under `forces`: it holds them all.
/// When they are all parallel any plane through them would do; the one towards global +x is taken
/// (+y for a rod along x), which also decides to which side an upright rod buckles.
/// @return nothing if the forces leave the plane by more than 1e-12 of the largest one
[[nodiscard]] std::optional<Plane> find_plane(const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction,
                                              const std::vector<Eigen::Vector3d>& forces);

}  // namespace dlo::energy_model
