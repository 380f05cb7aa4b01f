#include "judge/nonnegative_least_squares.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace dlo::compare {
namespace {

/// Cosine between a column and what is left of b below which it is no descent direction but
/// rounding.
constexpr double rounding = 1e-12;

Eigen::MatrixXd columns(const Eigen::MatrixXd& A, const std::vector<Eigen::Index>& which) {
  Eigen::MatrixXd result(A.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = A.col(which[i]);
  }
  return result;
}

/// As far towards the free solution as all stay nonnegative; what gets to zero is passive no more.
void step_to_bound(const Eigen::VectorXd& free, std::vector<Eigen::Index>& passive,
                   Eigen::VectorXd& x) {
  double part = 1;
  for (std::size_t i = 0; i < passive.size(); ++i) {
    const double to = free[static_cast<Eigen::Index>(i)];
    const double from = x[passive[i]];
    if (to <= 0) part = std::min(part, from > to ? from / (from - to) : 0.0);
  }
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < passive.size(); ++i) {
    const double to = free[static_cast<Eigen::Index>(i)];
    double& value = x[passive[i]];
    const double scale = std::abs(to) + value;
    value += part * (to - value);
    if (to <= 0 && value <= 8 * std::numeric_limits<double>::epsilon() * scale) {
      value = 0;
    } else {
      kept.push_back(passive[i]);
    }
  }
  passive = std::move(kept);
}

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const Eigen::Index n = A.cols();
  // Columns of length 1, so that none is preferred for its unit.
  Eigen::VectorXd lengths = A.colwise().norm();
  Eigen::MatrixXd unit = A;
  for (Eigen::Index j = 0; j < n; ++j) {
    if (lengths[j] > 0) unit.col(j) /= lengths[j];
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> passive;
  std::vector<bool> is_out(static_cast<std::size_t>(n), false);  // came in and went at once
  const Eigen::Index most = 3 * n + 10;                          // more has never been seen to help
  for (Eigen::Index round = 0; round < most; ++round) {
    const Eigen::VectorXd left = b - unit * x;
    const Eigen::VectorXd slope = unit.transpose() * left;
    Eigen::Index entering = -1;
    double steepest = rounding * b.norm();
    for (Eigen::Index j = 0; j < n; ++j) {
      if (x[j] > 0 || is_out[static_cast<std::size_t>(j)] || !(slope[j] > steepest)) continue;
      steepest = slope[j];
      entering = j;
    }
    if (entering < 0) break;
    passive.push_back(entering);
    while (!passive.empty()) {
      const Eigen::VectorXd free = columns(unit, passive).colPivHouseholderQr().solve(b);
      if (free.minCoeff() > 0) {
        for (std::size_t i = 0; i < passive.size(); ++i) {
          x[passive[i]] = free[static_cast<Eigen::Index>(i)];
        }
        break;
      }
      step_to_bound(free, passive, x);
    }
    // A column that rounding lets in and out again would do so for ever.
    if (x[entering] > 0) {
      is_out.assign(is_out.size(), false);
    } else {
      is_out[static_cast<std::size_t>(entering)] = true;
    }
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    if (lengths[j] > 0) x[j] /= lengths[j];
  }
  return x;
}

}  // namespace dlo::compare
