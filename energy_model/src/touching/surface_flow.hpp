#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "dlo/obstacle/body.hpp"

namespace dlo::energy_model {

/// Cross-section of a round, naturally straight rod without twist, in units of l and EI: position
/// r, unit tangent t, v = dt/ds and force n of what lies beyond on what lies before, one below the
/// other.
template <class T>
using FlowState = Eigen::Matrix<T, 12, 1>;

/// The feature of a body on which a rod lies: a plane, a cylinder about an axis or a ball,
///     gap = |P (r - centre)| - radius,  P the projection across the axis (identity of a ball),
/// of a plane normal . (r - centre).
struct Surface {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();        ///< of a plane
  Eigen::Matrix3d across = Eigen::Matrix3d::Zero();         ///< P; zero of a plane
  double radius = std::numeric_limits<double>::infinity();  ///< infinite of a plane

  [[nodiscard]] double bend() const { return 1 / radius; }
  [[nodiscard]] double gap(const Eigen::Vector3d& r) const;
  /// Outward at r, of the surface through it; across * (r - centre) / radius on the surface.
  [[nodiscard]] Eigen::Vector3d outward(const Eigen::Vector3d& r) const;
};

/// That of a body next to a point outside of its core.
[[nodiscard]] Surface surface_of(const obstacle::Body& body, const Eigen::Vector3d& near);

/// Pressure p of a surface on a rod that lies on it, from what keeps it there,
///     n.N = 3 t.P v / R,   p = 4 n.P t / R - w.N - 3 (v.P v + (n.t - v.v) t.P t) / R.
[[nodiscard]] double pressure(const Surface& surface, const Eigen::Vector3d& weight,
                              const FlowState<double>& state);

/// d/ds of a cross-section,
///     r' = t,  t' = v,  v' = (n.t - v.v) t - n,  n' = -w,  and -w - p N where the rod lies.
[[nodiscard]] FlowState<double> rate_of(const std::optional<Surface>& surface,
                                        const Eigen::Vector3d& weight,
                                        const FlowState<double>& state);

/// Brings a cross-section on by Taylor's series of order 20 in steps that are short against the
/// distance to a pole. @param surface  on which the rod lies; nothing: it is free
[[nodiscard]] FlowState<double> flow(const std::optional<Surface>& surface,
                                     const Eigen::Vector3d& weight, double length,
                                     const FlowState<double>& state);

/// Derivative of flow() by the cross-section that it starts from.
[[nodiscard]] Eigen::Matrix<double, 12, 12> transition(const std::optional<Surface>& surface,
                                                       const Eigen::Vector3d& weight, double length,
                                                       const FlowState<double>& state);

}  // namespace dlo::energy_model
