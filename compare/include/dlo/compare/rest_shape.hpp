#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A stress-free shape fitted to points in space, as arcs of constant strain and equal length, and
/// the residuals of the fit. If the points have no frames, d1 and d2 follow the arcs by parallel
/// transport, and the shape has no twist.
struct RestShape {
  /// Arc of constant strain, from the end of the previous arc to its own.
  struct Arc {
    double end = 0;          ///< arc length [m]
    Eigen::Vector3d strain;  ///< curvature about d1 and d2, twist [1/m]

    /// Compares all fields.
    bool operator==(const Arc&) const = default;
  };
  std::string file;          ///< file of the points, for messages
  long points = 0;           ///< number of points
  std::vector<Arc> arcs;     ///< one or more, the last one ends at the rod's length
  double largest_error = 0;  ///< largest distance of a point from the arcs at its arc length [m]
  double rms_error = 0;      ///< RMS distance of all points from the arcs at their arc lengths [m]
  /// Largest angle between a given d1 and that of the arcs [rad]; empty without frames.
  std::optional<double> largest_angle = std::nullopt;
  /// Start of the arcs, in the axes of the points: a rod that is held there lies on them [m].
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  /// Frame at the start of the arcs, columns d1, d2, t. Without given frames d2 is the normal of
  /// the points' plane, on the side of +z (+y, +x). If the points are not planar, the fit only
  /// starts with d2 near the normal of the plane of best fit.
  Eigen::Matrix3d first_frame = Eigen::Matrix3d::Identity();

  /// Compares all fields.
  bool operator==(const RestShape&) const = default;
};

/// Largest number of arcs of a rest shape: the cost of a solve grows with their number.
inline constexpr int most_rest_arcs = 32;

/// Fits arcs to points, at most 150 of them, by nonlinear least squares in strains and pose. Of 1,
/// 2, 3, 4, 6, 8, 12, 16, 24 and 32 arcs it uses the number with the least value of Schwarz's
/// information criterion. Larger numbers are not tried after three in a row that are worse, or
/// after one that agrees with the points within about 1e-7 of the length. Two arcs or more need two
/// residuals per parameter. Points within 1e-6 of the length from a plane count as planar, unless a
/// given d1 leaves it. Arc lengths, scaled to the rod's length, are the file's (decreasing ones
/// reverse the points), else those of the nearest points. Of given frames only d1 is used; in the
/// points' plane it determines the side of d2.
/// @param length  of the rod [m]
/// @throws InputError if the length of the points' curve differs by more than 5 %, there are fewer
/// than 5 points, or d1 rotates by a right angle or more between fitted neighbours
[[nodiscard]] RestShape fit_rest_shape(const MeasuredShape& measured, double length);

/// Returns the strain of a helix, curvature about d1 and d2 and twist: [0, R / (R^2 + c^2), c /
/// (R^2 + c^2)] [1/m] with c = pitch / (2 pi). The helix begins along t; its axis is at the
/// distance R along d1.
/// @param radius  R [m], > 0
/// @param pitch  advance per turn [m]; > 0 right-handed, < 0 left-handed, 0 a circle
[[nodiscard]] Eigen::Vector3d helix_strain(double radius, double pitch);

}  // namespace dlo::compare
