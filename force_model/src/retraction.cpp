#include "retraction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dlo::force_model {
namespace {

/// Number of Newton steps (2). The next solve treats remaining errors of length as stretch.
constexpr int most_corrections = 4;
/// Relative accuracy of the lengths.
constexpr double length_tolerance = 1e-13;
/// Added to the diagonal of J J^T, which is 1 next to an anchor and else 2. If a part between two
/// anchors is straight, no movement changes all its lengths equally; the corresponding y is then
/// suppressed.
constexpr double straight_share = 1e-9;
/// Smallest factor by which one movement may shorten a segment.
constexpr double least_length_factor = 0.1;

}  // namespace

Retraction::Retraction(std::vector<char> anchors)
    : anchors_(std::move(anchors)),
      segments_(3, anchors_.size() - 1),
      lengths_(anchors_.size() - 1),
      multiplier_(anchors_.size()),
      upper_(anchors_.size()) {}

void Retraction::move(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& movement,
                      double share, Eigen::Matrix3Xd& moved) {
  const Eigen::Index segments = segments_.cols();
  for (Eigen::Index i = 0; i < segments; ++i) {
    const Eigen::Vector3d a = points.col(i + 1) - points.col(i);
    const Eigen::Vector3d d = share * (movement.col(i + 1) - movement.col(i));
    const Eigen::Vector3d sum = a + d;
    const double length = a.norm();
    const double moved_length = sum.norm();
    lengths_[i] = length > 0 ? std::max(length + a.dot(d) / length, least_length_factor * length)
                             : moved_length;
    segments_.col(i) = moved_length > 0 ? Eigen::Vector3d(lengths_[i] / moved_length * sum) : a;
  }
  Eigen::Index anchor = -1;  // index of the last anchor
  for (Eigen::Index i = 0; i <= segments; ++i) {
    if (anchors_[static_cast<std::size_t>(i)] == 0) continue;
    moved.col(i) = points.col(i) + share * movement.col(i);
    if (anchor < 0) {
      for (Eigen::Index k = i; k > 0; --k) moved.col(k - 1) = moved.col(k) - segments_.col(k - 1);
    } else if (i > anchor + 1) {
      for (Eigen::Index k = anchor; k + 1 < i; ++k) {
        moved.col(k + 1) = moved.col(k) + segments_.col(k);
      }
      const Eigen::Vector3d residual = moved.col(i) - moved.col(i - 1) - segments_.col(i - 1);
      const auto count = static_cast<double>(i - anchor);
      for (Eigen::Index k = anchor + 1; k < i; ++k) {
        moved.col(k) += static_cast<double>(k - anchor) / count * residual;
      }
      restore_lengths(anchor, i, moved);
    }
    anchor = i;
  }
  if (anchor < 0) moved.col(anchor = 0) = points.col(0) + share * movement.col(0);
  for (Eigen::Index k = anchor; k < segments; ++k) {
    moved.col(k + 1) = moved.col(k) + segments_.col(k);
  }
}

void Retraction::restore_lengths(Eigen::Index first, Eigen::Index last, Eigen::Matrix3Xd& moved) {
  double before = std::numeric_limits<double>::infinity();
  for (int correction = 0; correction < most_corrections; ++correction) {
    double worst = 0;
    for (Eigen::Index k = first; k < last; ++k) {
      const Eigen::Vector3d a = moved.col(k + 1) - moved.col(k);
      const double length = a.norm();
      multiplier_[k] = lengths_[k] - length;
      worst = std::max(worst, std::abs(multiplier_[k]) / lengths_[k]);
      segments_.col(k) = length > 0 ? Eigen::Vector3d(a / length) : Eigen::Vector3d::Zero();
    }
    if (!(worst > length_tolerance) || !(worst < before)) return;
    before = worst;
    // Tridiagonal system: each length depends on its two ends, and neighbours share an end.
    const auto free_ends = [&](Eigen::Index k) {
      return (k > first ? 1 : 0) + (k + 1 < last ? 1 : 0);
    };
    double pivot = free_ends(first) + straight_share;
    for (Eigen::Index k = first + 1; k < last; ++k) {
      const double off = -segments_.col(k - 1).dot(segments_.col(k));
      upper_[k - 1] = off / pivot;
      multiplier_[k] -= upper_[k - 1] * multiplier_[k - 1];
      multiplier_[k - 1] /= pivot;
      pivot = free_ends(k) + straight_share - off * upper_[k - 1];
    }
    multiplier_[last - 1] /= pivot;
    for (Eigen::Index k = last - 2; k >= first; --k) {
      multiplier_[k] -= upper_[k] * multiplier_[k + 1];
    }
    for (Eigen::Index k = first + 1; k < last; ++k) {
      moved.col(k) += multiplier_[k - 1] * segments_.col(k - 1) - multiplier_[k] * segments_.col(k);
    }
  }
}

}  // namespace dlo::force_model
