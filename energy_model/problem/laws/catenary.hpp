#pragma once

#include <Eigen/Core>
#include <optional>

namespace dlo::energy_model {

/// Of the length: arc lengths and heights that are meant to be the same.
inline constexpr double negligible_way = 1e-9;

/// A line without bending stiffness under its weight w per length, part of which may lie on the
/// level of its lowest point. Its arc lengths s begin at one end of it [m]. With q the arc length
/// from the lowest point,
///     height = (a^2 + q^2)^(1/2),  x = a asinh(q / a).
struct Catenary {
  double a = 0;            ///< T / w at the lowest point [m]; 0: a line that hangs straight
  double low = 0;          ///< s of that point; beyond the ends if the line rises all along
  double lying = 0;        ///< length that lies from there on
  Eigen::Vector3d origin;  ///< that point
  Eigen::Vector3d level;   ///< unit, along growing s
  Eigen::Vector3d up;      ///< unit

  /// Arc length from the lowest point, or from the end of what lies.
  [[nodiscard]] double own(double s) const;
  /// T / w there, which is the height above the line's directrix.
  [[nodiscard]] double height(double s) const;
  [[nodiscard]] bool lies(double s) const { return s > low && s < low + lying; }
  [[nodiscard]] Eigen::Vector3d point(double s) const;
  [[nodiscard]] Eigen::Vector3d tangent(double s) const;
  /// dt/ds [1/m]; none of what lies.
  [[nodiscard]] Eigen::Vector3d curvature(double s) const;
  /// int (height - a) ds from the lowest point to own arc length q [m^2].
  [[nodiscard]] double height_integral(double q) const;
  /// int |curvature|^2 ds from there on [1/m].
  [[nodiscard]] double bend_integral(double q) const;
};

/// Between two points, arc length l apart; none if they are above each other or as far as that.
/// @param up  unit
[[nodiscard]] std::optional<Catenary> hang_between(const Eigen::Vector3d& begin,
                                                   const Eigen::Vector3d& end, double l,
                                                   const Eigen::Vector3d& up);

/// The same on a floor that carries its lowest part; none if it does not.
/// @param floor  height along `up` [m]
[[nodiscard]] std::optional<Catenary> lie_between(const Eigen::Vector3d& begin,
                                                  const Eigen::Vector3d& end, double l,
                                                  const Eigen::Vector3d& up, double floor);

}  // namespace dlo::energy_model
