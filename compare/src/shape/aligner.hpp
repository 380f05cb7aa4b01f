#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {

/// Aligns one measured shape with many curves; see align().
class Aligner {
 public:
  /// @throws InputError in the cases of align()
  Aligner(const MeasuredShape& shape, double length, const AlignOptions& options);

  [[nodiscard]] Alignment align(const Curve& curve) const;

  [[nodiscard]] Eigen::Index points() const { return file_points_[0].points.cols(); }
  [[nodiscard]] ArcLengths arc_lengths() const { return rule_; }
  /// Returns the number of free coordinates of the motion: 0, 3, 4 or 6.
  [[nodiscard]] Eigen::Index free_coordinates() const;

 private:
  struct Placement {
    RigidMotion pose;
    std::vector<double> arc_length;
    double mean_square = 0;  // weighted
  };

  [[nodiscard]] bool has_free_arc_lengths() const { return rule_ == ArcLengths::nearest; }
  [[nodiscard]] Eigen::VectorXd weights(const std::vector<double>& s,
                                        const Eigen::Matrix3Xd& points) const;
  [[nodiscard]] RigidMotion closest_pose(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                         const Eigen::VectorXd& weight) const;
  [[nodiscard]] Placement fit_pose_at_given_arc_lengths(const Shape& way, const Curve& curve) const;
  /// Whether thinned() omits points.
  [[nodiscard]] bool is_dense() const;
  [[nodiscard]] static Shape thinned(const Shape& way);
  [[nodiscard]] std::vector<Placement> coarse_placements(const Shape& way,
                                                         const Curve& curve) const;
  [[nodiscard]] Placement refine_placement(const Shape& way, const Curve& curve,
                                           const RigidMotion& start) const;
  void gauss_newton(const Eigen::Matrix3Xd& points, const Curve& curve, Placement& placed) const;
  [[nodiscard]] Shape stretched_to_rod(Shape way) const;
  /// Returns the RMS distance that ShapeCheck reports for an aligned shape [m]. A file that is as
  /// long as the rod is compared with the whole rod.
  /// @param[out] measured  the distances
  [[nodiscard]] double reported_distance(const Alignment& aligned, const Curve& curve,
                                         Measured& measured) const;
  /// Iterates from a pose as long as reported_distance() decreases. This is needed because
  /// measure() redistributes points past an end, which is no part of the distances across the curve
  /// that refine_placement() minimises.
  [[nodiscard]] Alignment refine_by_reported_distance(const Shape& way, RigidMotion pose,
                                                      const Curve& curve) const;
  /// Returns the alignment of a placement. With nearest points, weights by length and a fitted
  /// frame it is refined by reported_distance(). A file that is as long as the rod is then aligned
  /// by lengths along it instead, where that gives the smaller distance.
  [[nodiscard]] Alignment aligned(std::size_t way, const Placement& nearest,
                                  const Curve& curve) const;
  [[nodiscard]] Placement best_placement_of_thinned(const Shape& way, const Curve& curve) const;
  [[nodiscard]] Placement best_placement(const Shape& way, const Curve& curve) const;
  [[nodiscard]] Alignment finished(const Placement& placed, bool reversed,
                                   const Curve& curve) const;

  double length_;
  AlignOptions options_;
  ArcLengths rule_ = ArcLengths::nearest;
  // Lengths along the points reach that of the rod, minus whole_rod_slack; false if they are given.
  bool covers_whole_rod_ = false;
  // With weights by length: as long as the rod within end_slack, so its ends are those of the rod.
  bool has_rod_ends_ = false;
  /// Points of a file that runs along the rod, and of one that runs against it. Arc lengths are as
  /// given, or estimates along the polyline.
  std::array<Shape, 2> file_points_;
};

}  // namespace dlo::compare
