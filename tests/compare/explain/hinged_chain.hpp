#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace dlo::test {

/// A hinged chain of a rod of 0.5 kg/m whose clamp points 20 degrees up, under its weight, by
/// Newton's method on its own equations.
class HingedChain {
 public:
  /// @param lengths  of the segments;  @param h  over which a spring EI/h stands for the rod
  /// @param lift  upwards on the end [N]
  HingedChain(std::vector<double> lengths, double h, double stiffness, bool welded, double lift = 0)
      : lengths_(std::move(lengths)), springs_(lengths_.size(), stiffness / h), welded_(welded) {
    double beyond = 0;
    carried_.resize(lengths_.size());
    for (std::size_t i = lengths_.size(); i-- > 0;) {
      carried_[i] = (beyond + lengths_[i] / 2) * weight - lift;
      beyond += lengths_[i];
    }
  }

  [[nodiscard]] Eigen::Matrix3Xd points() const {
    const auto n = static_cast<Eigen::Index>(lengths_.size());
    Eigen::VectorXd angle = Eigen::VectorXd::Constant(n, direction);
    for (int step = 0; step < 500; ++step) {
      Eigen::VectorXd residual = Eigen::VectorXd::Zero(n);
      Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(n, n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const double lever = carried_[k] * lengths_[k];
        residual[i] += lever * std::cos(angle[i]);
        slope(i, i) -= lever * std::sin(angle[i]);
        if (i == 0 && welded_) continue;
        const double turn = angle[i] - (i == 0 ? direction : angle[i - 1]);
        residual[i] += springs_[k] * turn;
        slope(i, i) += springs_[k];
        if (i == 0) continue;
        residual[i - 1] -= springs_[k] * turn;
        slope(i - 1, i - 1) += springs_[k];
        slope(i, i - 1) -= springs_[k];
        slope(i - 1, i) -= springs_[k];
      }
      if (welded_) {
        residual[0] = 0;
        slope.row(0).setZero();
        slope.col(0).setZero();
        slope(0, 0) = 1;
      }
      const Eigen::VectorXd way = -slope.partialPivLu().solve(residual);
      angle += std::min(1.0, 0.5 / way.cwiseAbs().maxCoeff()) * way;
      if (way.cwiseAbs().maxCoeff() < 1e-13) break;
    }
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, n + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double L = lengths_[static_cast<std::size_t>(i)];
      points.col(i + 1) =
          points.col(i) + L * Eigen::Vector3d(std::cos(angle[i]), std::sin(angle[i]), 0);
    }
    return points;
  }

 private:
  static constexpr double weight = 0.5 * 9.81;  // per length [N/m]
  static constexpr double direction = 20 * std::numbers::pi / 180;

  std::vector<double> lengths_;
  std::vector<double> springs_;  // of the hinge before each segment
  std::vector<double> carried_;
  bool welded_;
};

}  // namespace dlo::test
