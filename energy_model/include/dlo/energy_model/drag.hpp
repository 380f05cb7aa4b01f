#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Drag of a steady stream on a rod by Morison's quadratic law without inertia. The components
/// across and along the rod are independent (cross-flow principle; DNV-RP-C205, section 6):
///     f = normal |v_n| v_n + tangential |v_t| v_t,   v_t = (v.t) t,   v_n = v - v_t
/// per length. v is the velocity of the stream relative to the rod, t the tangent of the rod.
struct Drag {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< v [m/s]
  double normal = 0;                                   ///< 1/2 rho C_n d [kg/m^2], >= 0
  double tangential = 0;                               ///< 1/2 rho pi C_t d [kg/m^2], >= 0

  /// Returns the drag per length f [N/m]. @param tangent  unit vector
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& tangent) const;
  /// Returns the derivative of f with respect to the tangent, valid for changes across the tangent
  /// [N/m].
  [[nodiscard]] Eigen::Matrix3d by_tangent(const Eigen::Vector3d& tangent) const;
  /// Returns an upper bound of |f| over all tangents [N/m].
  [[nodiscard]] double largest() const;

  /// Compares all fields.
  bool operator==(const Drag&) const = default;
};

}  // namespace dlo::energy_model
