#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/deviation.hpp"

namespace dlo::compare {

/// A reference shape as cubic pieces between equally spaced arc lengths, for many quick searches of
/// nearest points. It is off by h^4/384 of the fourth derivative: 2e-9 of the length for a rod with
/// Gamma = 100.
class Curve {
 public:
  /// @param length  of the rod [m]; the pieces go from arc length 0 to it
  Curve(const Reference& reference, double length);

  [[nodiscard]] double length() const { return length_; }
  /// 0 <= s <= length [m].
  [[nodiscard]] Eigen::Vector3d point(double s) const { return at(s).point; }
  [[nodiscard]] Eigen::Vector3d tangent(double s) const { return at(s).tangent; }
  [[nodiscard]] Eigen::Matrix3Xd points(const std::vector<double>& s) const;

  /// Arc length, near `s`, of the curve's point nearest to a position [m].
  [[nodiscard]] double nearest(const Eigen::Vector3d& position, double s) const;

  /// Arc lengths that grow with the index and make the sum of squared distances least: the best of
  /// all choices of nodes (dynamic programming), each then moved to the nearest point close by.
  /// @param positions  [m], 3 x M
  [[nodiscard]] std::vector<double> nearest_in_order(const Eigen::Matrix3Xd& positions) const;

 private:
  struct Local {
    Eigen::Vector3d point, tangent, second;  // and derivatives by arc length
  };
  [[nodiscard]] Local at(double s) const;

  double length_;
  double step_;
  Eigen::Matrix3Xd nodes_;
  Eigen::Matrix3Xd tangents_;
};

}  // namespace dlo::compare
