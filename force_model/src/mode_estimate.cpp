#include "mode_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dlo::force_model {
namespace {

constexpr double older_block_weight = 0.8;

/// Ratio of estimate to true stiffness up to which the estimate is kept [-]. Below it, heavy_ball's
/// steps move the slowest mode at least half as fast as possible, which does not justify a restart.
constexpr double largest_kept_ratio = 2;

}  // namespace

ModeEstimate::ModeEstimate(const Rod& rod, const Eigen::Matrix3Xd& points)
    : modes_(mode_bounds(rod, points)), constraints_(constraint_stiffness(rod)) {
  const double rounding = std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff();
  rounding_ = 2 * static_cast<double>(points.cols()) * rounding * rounding;
}

void ModeEstimate::update(double inner_mode, double force_change, double point_change) {
  modes_.fastest = inner_mode + constraints_;
  const double lost = 4 * std::sqrt(modes_.slowest / modes_.fastest);  // 1 - c_h
  if (has_block_start_ && !(std::abs(force_change) <= modes_.fastest * rounding_ / lost)) {
    force_change_ = older_block_weight * force_change_ + force_change;
    point_change_ = older_block_weight * point_change_ + point_change;
    if (point_change_ > 0 && force_change_ > 0) modes_.slowest = force_change_ / point_change_;
  }
  modes_.slowest = std::clamp(modes_.slowest, smallest_mode_ratio * modes_.fastest, modes_.fastest);
  has_block_start_ = true;
}

void ModeEstimate::update_fastest(double inner_mode) {
  modes_.fastest = inner_mode + constraints_;
  modes_.slowest = std::clamp(modes_.slowest, smallest_mode_ratio * modes_.fastest, modes_.fastest);
  has_block_start_ = false;
}

void ModeEstimate::correct_slowest(double slowest) {
  if (!(modes_.slowest > largest_kept_ratio * slowest)) return;
  modes_.slowest = std::max(slowest, smallest_mode_ratio * modes_.fastest);
  force_change_ = 0;
  point_change_ = 0;
  has_block_start_ = false;
}

void ModeEstimate::change_environment(const Rod& rod, const Eigen::Matrix3Xd& points) {
  constraints_ = constraint_stiffness(rod);
  modes_.fastest = mode_bounds(rod, points).fastest;
  modes_.slowest = std::min(modes_.slowest, modes_.fastest);
  has_block_start_ = false;
}

}  // namespace dlo::force_model
