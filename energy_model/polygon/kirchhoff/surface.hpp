#pragma once

#include <Eigen/Core>
#include <limits>

#include "dlo/obstacle/body.hpp"
#include "kirchhoff/rod_state.hpp"

namespace dlo::energy_model {

/// Feature of a body on which a rod lies: a plane, a cylinder about an axis or a ball,
///     gap = |P (r - centre)| - radius,  P the projection across the axis (identity for a ball),
/// and for a plane gap = normal . (r - centre). Lengths are in l.
struct Surface {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();        ///< normal of a plane
  Eigen::Matrix3d across = Eigen::Matrix3d::Zero();         ///< P; zero for a plane
  double radius = std::numeric_limits<double>::infinity();  ///< infinite for a plane

  /// Returns the gap of a point, with derivatives.
  [[nodiscard]] obstacle::Gap gap(const Eigen::Vector3d& r) const;
};

/// Returns the surface of a body next to a point outside of its core.
[[nodiscard]] Surface surface_of(const obstacle::Body& body, const Eigen::Vector3d& near);

/// Derivatives by r, a spin of R, m and n, three columns each.
using ByState = Eigen::Matrix<double, Eigen::Dynamic, 12>;

/// Conditions for a cross-section that lies on a surface, which do not depend on the pressure. With
///     Y = (|P (r - centre)|^2 / radius - radius) / 2,  for a plane Y = gap,
/// they are Y = Y' = Y'' = Y''' = 0, derivatives by the arc length of an intrinsically straight
/// rod,
///     Y' = N.t,  Y'' = N.t' + t.A t,  Y''' = N.t'' + 3 t.A t',  A = P / radius.
struct LyingConditions {
  Eigen::Vector4d values;
  ByState by_state;
};
[[nodiscard]] LyingConditions lying_conditions(const Surface& surface, const RodSection& section,
                                               const RodState& state);

/// Force per length p of a surface on a rod that lies on it, along its outward normal. It follows
/// from Y'''' = 0 of lying_conditions(), which contains n' = -w - p N.
struct Pressure {
  double value = 0;
  Eigen::Matrix<double, 1, 12> by_state;
};
[[nodiscard]] Pressure pressure_with_derivatives(const Surface& surface, const RodSection& section,
                                                 const RodState& state);
[[nodiscard]] double pressure(const Surface& surface, const RodSection& section,
                              const RodState& state);

}  // namespace dlo::energy_model
