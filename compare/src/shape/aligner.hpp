#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {

/// Lays one measured shape on many curves, see align().
class Aligner {
 public:
  /// @throws InputError as align()
  Aligner(const MeasuredShape& shape, double length, const AlignOptions& options);

  [[nodiscard]] Alignment align(const Curve& curve) const;

  [[nodiscard]] Eigen::Index points() const { return ways_[0].points.cols(); }
  [[nodiscard]] ArcLengths arc_lengths() const { return rule_; }
  /// Coordinates of the motion that are free: 0, 3, 4 or 6.
  [[nodiscard]] Eigen::Index free_coordinates() const;

 private:
  /// The file's points by growing arc length, if the file runs along the rod or against it.
  struct Way {
    Eigen::Matrix3Xd points;
    std::vector<double> arc_length;  // given, or a guess along the polyline
  };
  struct Placed {
    RigidMotion pose;
    std::vector<double> arc_length;
    double mean_square = 0;  // weighted
  };

  [[nodiscard]] bool has_free_arc_lengths() const { return rule_ == ArcLengths::nearest; }
  [[nodiscard]] Eigen::VectorXd weights(const std::vector<double>& s,
                                        const Eigen::Matrix3Xd& points) const;
  [[nodiscard]] RigidMotion closest_pose(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                         const Eigen::VectorXd& weight) const;
  [[nodiscard]] Placed place_given(const Way& way, const Curve& curve) const;
  /// Whether thinned() leaves points out.
  [[nodiscard]] bool is_dense() const;
  [[nodiscard]] static Way thinned(const Way& way);
  [[nodiscard]] std::vector<Placed> coarse_places(const Way& way, const Curve& curve) const;
  [[nodiscard]] Placed refine_all(const Way& way, const Curve& curve,
                                  const RigidMotion& start) const;
  /// The same by way of fewer points, so that many need few steps.
  [[nodiscard]] Placed refine(const Way& way, const Curve& curve, const RigidMotion& start) const;
  void gauss_newton(const Eigen::Matrix3Xd& points, const Curve& curve, Placed& placed) const;
  [[nodiscard]] Way stretched_to_rod(Way way) const;
  /// What check tells of a laid shape: of a file that is as long as the rod as the whole rod.
  [[nodiscard]] double told_distance(const Alignment& laid, const Curve& curve,
                                     Measured& measured) const;
  /// Goes on from a pose as long as told_distance() falls: what measure() does with points past an
  /// end is no part of the distances across the curve, which refine() makes least.
  [[nodiscard]] Alignment spread(const Way& way, RigidMotion pose, const Curve& curve) const;
  /// Nearest points, unless lengths along a whole file lay it nearer.
  [[nodiscard]] Alignment laid(std::size_t way, const Placed& nearest, const Curve& curve) const;
  /// Of the thinned points.
  [[nodiscard]] Placed best_of_few(const Way& way, const Curve& curve) const;
  [[nodiscard]] Placed best_place(const Way& way, const Curve& curve) const;
  [[nodiscard]] Alignment finished(const Placed& placed, bool reversed, const Curve& curve) const;

  double length_;
  AlignOptions options_;
  ArcLengths rule_ = ArcLengths::nearest;
  bool is_whole_ = false;      // as long as the rod, or nearly
  bool has_rod_ends_ = false;  // as long as the rod: its ends are laid on the rod's
  std::array<Way, 2> ways_;    // along, against
};

}  // namespace dlo::compare
