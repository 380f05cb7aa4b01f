#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Drag of a steady stream on a rod, Morison's quadratic law without inertia, the parts across and
/// along the rod each on their own (cross-flow principle; DNV-RP-C205, section 6):
///     f = normal |v_n| v_n + tangential |v_t| v_t,   v_t = (v.t) t,   v_n = v - v_t
/// per length, v the velocity of the stream against the rod, t the rod's tangent.
struct Drag {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< v [m/s]
  double normal = 0;                                   ///< 1/2 rho C_n d [kg/m^2], >= 0
  double tangential = 0;                               ///< 1/2 rho pi C_t d [kg/m^2], >= 0

  /// f [N/m]. @param tangent  unit
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& tangent) const;
  /// Its derivative by the tangent, for changes across it.
  [[nodiscard]] Eigen::Matrix3d by_tangent(const Eigen::Vector3d& tangent) const;
  /// No |f| is larger [N/m].
  [[nodiscard]] double largest() const;

  /// In every field.
  bool operator==(const Drag&) const = default;
};

}  // namespace dlo::energy_model
