#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// A stress-free shape that points in space say, as arcs of constant strain, and what they leave of
/// the points. Where these have no frames, d1 and d2 are carried along it by parallel transport: it
/// has no twist.
struct RestShape {
  /// From the end of the arc before it to its own.
  struct Arc {
    double end = 0;          ///< arc length [m]
    Eigen::Vector3d strain;  ///< curvature about d1 and d2, twist [1/m]

    /// In every field.
    bool operator==(const Arc&) const = default;
  };
  std::string file;          ///< of the points, for messages
  long points = 0;           ///< how many
  std::vector<Arc> arcs;     ///< one or more, the last one ends at the rod's length
  double largest_error = 0;  ///< of a point, its distance from the arcs [m]
  double rms_error = 0;      ///< of all points [m]
  /// Of a given d1, its angle from that of the arcs [rad]; none without frames.
  std::optional<double> largest_angle = std::nullopt;
  /// Where the arcs begin, in the axes of the points: a rod that is held there lies on them [m].
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  /// Columns d1, d2, t there. Without given frames d2 is the normal of the points' plane, or of the
  /// plane that is nearest to them but for what of it is along t, on the side of +z (+y, +x).
  Eigen::Matrix3d first_frame = Eigen::Matrix3d::Identity();

  /// In every field.
  bool operator==(const RestShape&) const = default;
};

/// Most arcs of a rest shape: what each costs a solver grows with their number.
inline constexpr int most_rest_arcs = 32;

/// The fewest arcs, up to most_rest_arcs, that say as much about the points as these do (Schwarz's
/// information criterion), by nonlinear least squares in strains, ends and pose. Points within
/// 1e-6 of the length from a plane are taken as in it. Arc lengths are the file's if it has any,
/// else those of the nearest points; both are scaled to the rod's length.
/// Frames that are given are d1's alone; in the points' plane they say d2's side.
/// @param length  of the rod [m]
/// @throws InputError if the points' curve is not as long, within 5 %, there are fewer than 5, or
/// d1 rotates by a right angle or more between neighbours that are fitted
[[nodiscard]] RestShape fit_rest_shape(const MeasuredShape& measured, double length);

/// Curvature of a helix about d2 and its twist, [0, R / (R^2 + c^2), c / (R^2 + c^2)] [1/m] with c
/// = pitch / (2 pi). It begins along t, its axis is the radius away along d1.
/// @param radius  R [m], > 0
/// @param pitch  rise for each turn [m]; > 0 right-handed, < 0 left-handed, 0 a circle
[[nodiscard]] Eigen::Vector3d helix_strain(double radius, double pitch);

}  // namespace dlo::compare
