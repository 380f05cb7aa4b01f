#include "mode_estimate.hpp"

#include <algorithm>

namespace dlo::force_model {
namespace {

constexpr double memory = 0.8;  // weight of older blocks

}  // namespace

ModeEstimate::ModeEstimate(const Rod& rod, const Eigen::Matrix3Xd& points)
    : modes_(mode_bounds(rod, points)),
      slowest_expected_(modes_.slowest),
      last_points_(points),
      last_forces_(Eigen::Matrix3Xd::Zero(3, points.cols())) {}

void ModeEstimate::update(const Rod& rod, const Eigen::Matrix3Xd& points,
                          const Eigen::Matrix3Xd& forces) {
  modes_.fastest = mode_bounds(rod, points).fastest;
  if (has_last_) {
    last_forces_ -= forces;
    last_points_ = points - last_points_;
    force_change_ = memory * force_change_ + last_forces_.cwiseProduct(last_points_).sum();
    point_change_ = memory * point_change_ + last_points_.squaredNorm();
    if (point_change_ > 0 && force_change_ > 0) modes_.slowest = force_change_ / point_change_;
    modes_.slowest = std::clamp(modes_.slowest, 1e-10 * modes_.fastest, modes_.fastest);
  }
  last_points_ = points;
  last_forces_ = forces;
  has_last_ = true;
}

}  // namespace dlo::force_model
