#pragma once

#include <Eigen/Core>
#include <vector>

namespace dlo::force_model {

/// Applies finite movements to a polygon as if they were rates: the rotation of a segment from a
/// linear solve does not stretch it. With a segment a and the difference d between the movements of
/// its end and its beginning, u = a/|a|,
///     |a'| = |a| + u.d,   a'/|a'| along a + d                                            (1)
/// where |a'| is at least |a|/10. Anchors, or P_0 if there are none, move exactly as given.
/// A part between an anchor and a free end is built from (1). A part between two anchors is built
/// from the first one. The remaining gap at the second anchor is distributed over its points in
/// proportion, and Newton steps on the lengths alone,
///     J J^T y = lengths (1) - lengths,   P += J^T y                                        (2)
/// restore the lengths, where J is the derivative of the lengths by the inner points. Only the
/// constructor allocates.
class Retraction {
 public:
  /// @param anchors  1 for points that move exactly as given
  explicit Retraction(std::vector<char> anchors);

  /// Moves the points. @param points  present positions [m];  @param movement  [m], multiplied by
  /// `share`
  /// @param[out] moved  new positions [m]; all 3 x points
  void move(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& movement, double share,
            Eigen::Matrix3Xd& moved);

 private:
  void restore_lengths(Eigen::Index first, Eigen::Index last, Eigen::Matrix3Xd& moved);

  std::vector<char> anchors_;
  Eigen::Matrix3Xd segments_;   // a', then its unit vectors
  Eigen::VectorXd lengths_;     // |a'| of (1)
  Eigen::VectorXd multiplier_;  // y of (2)
  Eigen::VectorXd upper_;       // upper diagonal in the elimination of the tridiagonal matrix
};

}  // namespace dlo::force_model
