#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::force_model {

/// Moves a polygon by finite movements that are meant as rates: what a linear solve calls a turn of
/// a segment becomes a turn and does not stretch it. With a a segment and d how much more its end
/// moves than its beginning, u = a/|a|,
///     |a'| = |a| + u.d,   a'/|a'| along a + d                                            (1)
/// Anchors move as they are told. A part between an anchor and a free end is put together from (1).
/// One between two anchors is put together from the first; by what then remains to the other, its
/// points are moved in proportion, and Newton steps on the lengths alone,
///     J J^T y = lengths (1) - lengths,   P += J^T y                                        (2)
/// give them back, J the derivative of the lengths by the points between. Only the constructor
/// allocates.
class Retraction {
 public:
  /// @param anchors  1 for points that move as they are told
  explicit Retraction(std::vector<char> anchors);

  /// @param points  where they are [m];  @param movement  of them [m], times `share`
  /// @param[out] moved  [m]; all 3 x points
  void move(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& movement, double share,
            Eigen::Matrix3Xd& moved);

 private:
  void restore_lengths(Eigen::Index first, Eigen::Index last, Eigen::Matrix3Xd& moved);

  std::vector<char> anchors_;
  Eigen::Matrix3Xd segments_;   // a', then unit vectors
  Eigen::VectorXd lengths_;     // |a'| of (1)
  Eigen::VectorXd multiplier_;  // y of (2)
  Eigen::VectorXd upper_;       // of the tridiagonal elimination
};

}  // namespace dlo::force_model
