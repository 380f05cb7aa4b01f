#pragma once

#include <Eigen/Core>
#include <optional>

namespace dlo::energy_model {

/// Difference of arc lengths or heights, divided by the length, up to which they are treated as
/// equal.
inline constexpr double negligible_length = 1e-9;

/// Catenary: the shape of a line without bending stiffness under its weight w per length. The line
/// may lie on a level floor along an interval that begins at its lowest point. Its arc length s is
/// measured from one of its ends [m]. Where the line hangs, q is the arc length of
/// hanging_arc_length(), and
///     height = (a^2 + q^2)^(1/2),  x = a asinh(q / a).
struct Catenary {
  double a = 0;    ///< T / w at the lowest point [m]; 0: a line that hangs straight
  double low = 0;  ///< s of the lowest point [m]; beyond an end if the line rises all along
  double lying_length = 0;     ///< length of the part from `low` on that lies [m]
  Eigen::Vector3d origin;      ///< lowest point [m]
  Eigen::Vector3d horizontal;  ///< horizontal unit vector along growing s
  Eigen::Vector3d up;          ///< vertical unit vector

  /// Returns the arc length from the lowest point, negative before it, or beyond it from the end of
  /// the part that lies [m]; 0 on that part.
  [[nodiscard]] double hanging_arc_length(double s) const;
  /// Returns T / w [m], which is the height above the line's directrix.
  [[nodiscard]] double height(double s) const;
  [[nodiscard]] bool is_lying(double s) const { return s > low && s < low + lying_length; }
  [[nodiscard]] Eigen::Vector3d point(double s) const;
  [[nodiscard]] Eigen::Vector3d tangent(double s) const;
  /// Returns the derivative of the tangent by s [1/m]; zero on the part that lies.
  [[nodiscard]] Eigen::Vector3d curvature(double s) const;
  /// Returns int (height - a) ds from the lowest point to the arc length q of hanging_arc_length()
  /// [m^2].
  [[nodiscard]] double height_integral(double q) const;
  /// Returns int |curvature|^2 ds from the lowest point to the arc length q of hanging_arc_length()
  /// [1/m].
  [[nodiscard]] double squared_curvature_integral(double q) const;
};

/// Computes the catenary of length l between two points; std::nullopt if they are above each other
/// or at least l apart.
/// @param up  vertical unit vector
[[nodiscard]] std::optional<Catenary> hanging_catenary(const Eigen::Vector3d& begin,
                                                       const Eigen::Vector3d& end, double l,
                                                       const Eigen::Vector3d& up);

/// Computes the catenary of length l between two points on a floor that carries its lowest part;
/// std::nullopt if the floor carries none of it, if the line is so long that its tension vanishes
/// (a < 1e-6 l), or if the points are above each other. Points below the floor are moved up to it.
/// @param floor  height of the floor along `up` [m]
[[nodiscard]] std::optional<Catenary> catenary_on_floor(const Eigen::Vector3d& begin,
                                                        const Eigen::Vector3d& end, double l,
                                                        const Eigen::Vector3d& up, double floor);

}  // namespace dlo::energy_model
