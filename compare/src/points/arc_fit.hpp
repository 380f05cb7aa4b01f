#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "dlo/compare/rest_shape.hpp"

namespace dlo::compare {

/// Where a rod that has the strains of an arc is behind its begin, and its frame there.
struct ArcPlace {
  Eigen::Vector3d point;
  Eigen::Matrix3d frame;  ///< d1, d2, t
};

/// @param s  arc length from the begin, negative before it
[[nodiscard]] ArcPlace along_arc(const ArcPlace& begin, const Eigen::Vector3d& strain, double s);

/// Arcs and where they are.
struct Arcs {
  ArcPlace begin;
  std::vector<RestShape::Arc> arcs;
};

/// Points of arcs at many arc lengths; the arcs outlive it.
class ArcTrace {
 public:
  explicit ArcTrace(const Arcs& arcs);
  [[nodiscard]] std::size_t arc_of(double s) const;
  [[nodiscard]] ArcPlace at(double s) const;
  /// Of each arc, and where the last one ends.
  [[nodiscard]] const std::vector<ArcPlace>& begins() const { return begins_; }

 private:
  const std::vector<RestShape::Arc>& arcs_;
  std::vector<ArcPlace> begins_;
};

/// Points to fit, and what is known of their arc lengths.
struct ArcTarget {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd d1;  ///< of frames there; empty: arcs have no twist
  std::vector<double> s;
  bool knows_s = false;  ///< else that of inner points is that of the nearest point
  double length = 0;
  bool planar = false;
  Eigen::Vector3d normal;  ///< of the plane, or of that which is nearest

  /// Whether arcs may have a twist, which frames say.
  [[nodiscard]] bool twists() const { return d1.cols() > 0 && !planar; }
  /// Rows of the residual for each point.
  [[nodiscard]] Eigen::Index rows() const { return twists() ? 4 : 3; }
  /// How many of these are independent, as what lies along the rod says nothing; and how many
  /// strains an arc has.
  [[nodiscard]] Eigen::Index numbers() const { return planar ? 1 : rows() - 1; }

  /// Whether a point's arc length is that of the nearest point.
  [[nodiscard]] bool slides(Eigen::Index i) const {
    return !knows_s && i > 0 && i + 1 < points.cols();
  }
};

/// What an angle counts beside a distance over the length: as long as the shortest of equal arcs.
inline constexpr double frame_lever = 1.0 / most_rest_arcs;

/// Of the points from the arcs over the length, three rows each; with frames a fourth one, the
/// angle of d1 times frame_lever.
[[nodiscard]] Eigen::VectorXd arc_residual(const ArcTarget& target, const Arcs& arcs);

/// Moves the arc lengths that are not known to those of the nearest points.
void slide_along(ArcTarget& target, const Arcs& arcs);

/// How many numbers say so many arcs and their pose.
[[nodiscard]] Eigen::Index arc_parameters(const ArcTarget& target, std::size_t arcs);

/// When an iteration ends.
struct ArcEffort {
  int most_steps;
  double least_gain;  ///< of the sum of squares in a step, a share of it
};

/// Levenberg and Marquardt's method; arc lengths that are not known follow.
/// @return the sum of squares over the length's
double improve_arcs(ArcTarget& target, Arcs& arcs, const ArcEffort& effort);

}  // namespace dlo::compare
