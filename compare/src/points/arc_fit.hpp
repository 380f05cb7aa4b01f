#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/compare/rest_shape.hpp"

namespace dlo::compare {

/// Position and frame of a rod with the strains of an arc, at some arc length.
struct ArcPlace {
  Eigen::Vector3d point;
  Eigen::Matrix3d frame;  ///< d1, d2, t
};

/// Returns position and frame at arc length `s` from the begin of an arc of constant strain.
/// @param s  negative before the begin
[[nodiscard]] ArcPlace along_arc(const ArcPlace& begin, const Eigen::Vector3d& strain, double s);

/// A sequence of arcs, with the position and frame where the first one begins.
struct Arcs {
  ArcPlace begin;
  std::vector<RestShape::Arc> arcs;
};

/// Evaluates points of arcs at many arc lengths; refers to the arcs, which must outlive it.
class ArcTrace {
 public:
  explicit ArcTrace(const Arcs& arcs);
  [[nodiscard]] std::size_t arc_of(double s) const;
  [[nodiscard]] ArcPlace at(double s) const;
  /// Returns position and frame at the begin of each arc and at the end of the last one.
  [[nodiscard]] const std::vector<ArcPlace>& begins() const { return begins_; }

 private:
  const std::vector<RestShape::Arc>& arcs_;
  std::vector<ArcPlace> begins_;
};

/// Points to fit by arcs, and what is known of their arc lengths.
struct ArcTarget {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd d1;  ///< first directors of the frames at the points; empty: arcs have no twist
  std::vector<double> s;
  bool knows_s = false;  ///< false: inner points have the arc length of the nearest point
  double length = 0;
  bool planar = false;
  Eigen::Vector3d normal;  ///< unit normal of the plane of the points, or nearest to them

  /// Whether arcs may have a twist, which only frames determine.
  [[nodiscard]] bool twists() const { return d1.cols() > 0 && !planar; }
  /// Returns the number of rows of the residual for each point.
  [[nodiscard]] Eigen::Index rows() const { return twists() ? 4 : 3; }
  /// Returns the number of independent residuals per point, since the residual along the rod is not
  /// independent. It is also the number of strains of an arc.
  [[nodiscard]] Eigen::Index numbers() const { return planar ? 1 : rows() - 1; }

  /// Whether a point's arc length is unknown and follows from the nearest point of the arcs.
  [[nodiscard]] bool slides(Eigen::Index i) const {
    return !knows_s && i > 0 && i + 1 < points.cols();
  }
};

/// Weight of an angle [rad] in the residual, compared with a distance divided by the length: the
/// length of the shortest of equal arcs, as a share of the rod.
inline constexpr double frame_lever = 1.0 / most_rest_arcs;

/// Returns the residual: the vectors from the points to the arcs, divided by the length, three rows
/// per point; with frames a fourth row, the angle of d1 times frame_lever. A vector of a point that
/// slides() has no component along the arc.
[[nodiscard]] Eigen::VectorXd arc_residual(const ArcTarget& target, const Arcs& arcs);

/// Replaces unknown arc lengths by those of the nearest points of the arcs.
void slide_along(ArcTarget& target, const Arcs& arcs);

/// Returns the number of parameters of so many arcs and their pose.
[[nodiscard]] Eigen::Index arc_parameters(const ArcTarget& target, std::size_t arcs);

/// Stopping criteria of improve_arcs().
struct ArcEffort {
  int most_steps;
  double least_gain;  ///< smallest relative decrease of the sum of squares in a step
};

/// Fits arcs by the Levenberg-Marquardt method; unknown arc lengths are updated with them.
/// @return the sum of squared residuals, which are distances divided by the length
double improve_arcs(ArcTarget& target, Arcs& arcs, const ArcEffort& effort);

}  // namespace dlo::compare
