#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "../helpers.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/step_size.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::test {

/// Steps written with total_forces and Eigen, as the formulas stand in the paper: what the kernel
/// has to agree with and what its speed is compared with.
class PlainSimulation {
 public:
  PlainSimulation(force_model::Rod rod, Eigen::Matrix3Xd points,
                  const force_model::StepOptions& options)
      : rod_(std::move(rod)), options_(options), points_(std::move(points)) {
    const Eigen::Index n = points_.cols();
    forces_.setZero(3, n);
    movement_.setZero(3, n);
    proposed_.setZero(3, n);
    block_points_.setZero(3, n);
    block_forces_.setZero(3, n);
    turned_back_.setConstant(n, false);
    free_.setOnes(n);
    for (const force_model::Grip& grip : rod_.grips) {
      if (grip.hold == force_model::GripHold::spring) continue;
      free_.segment(grip.first_point, grip.targets.cols()).setZero();
      points_.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
    }
    if (options_.policy.automatic && options_.l_s == 0) {
      options_.l_s = rod_.rest_lengths.minCoeff() / 4;
    }
    modes_ = mode_bounds(rod_, points_);
    const double rounding = std::numeric_limits<double>::epsilon() * points_.cwiseAbs().maxCoeff();
    mode_rounding_ = 2 * static_cast<double>(n) * rounding * rounding;
  }

  [[nodiscard]] force_model::StepResult step() {
    total_forces(rod_, points_, forces_);
    forces_.array().rowwise() *= free_.transpose();
    if (steps_ % 16 == 0) choose_step();
    const force_model::StepPolicy& policy = options_.policy;
    proposed_ = options_.c_F * forces_;
    if (policy.momentum) proposed_ += options_.c_h * movement_;  // (19)
    force_model::StepResult result;
    result.movement = largest_movement();
    if (!std::isfinite(result.movement) || !std::isfinite(proposed_.sum())) return result;
    if (policy.damping) update_damping();
    result.status = force_model::StepStatus::good;
    result.c_m = 1 / c_s_;
    if (policy.limit != force_model::StepLimit::none && result.movement > options_.l_s) {
      result.c_m *= options_.l_s / result.movement;  // (17), (18), (20)
      result.limited = true;
    }
    movement_ = result.c_m * proposed_;
    points_ += movement_;
    ++steps_;
    return result;
  }

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }
  [[nodiscard]] const Eigen::Matrix3Xd& forces() const { return forces_; }

 private:
  void choose_step() {
    modes_.fastest = mode_bounds(rod_, points_).fastest;
    rounding_ = 1024 * std::numeric_limits<double>::epsilon() * points_.cwiseAbs().maxCoeff();
    if (has_block_start_) {
      block_forces_ -= forces_;
      block_points_ = points_ - block_points_;
      const double change = block_forces_.cwiseProduct(block_points_).sum();
      const double lost = 4 * std::sqrt(modes_.slowest / modes_.fastest);
      if (!(std::abs(change) <= modes_.fastest * mode_rounding_ / lost)) {
        force_change_ = 0.8 * force_change_ + change;
        point_change_ = 0.8 * point_change_ + block_points_.squaredNorm();
        if (point_change_ > 0 && force_change_ > 0) modes_.slowest = force_change_ / point_change_;
      }
    }
    modes_.slowest = std::clamp(modes_.slowest, force_model::smallest_mode_ratio * modes_.fastest,
                                modes_.fastest);
    block_points_ = points_;
    block_forces_ = forces_;
    has_block_start_ = true;
    if (!options_.policy.automatic) return;
    const force_model::HeavyBall chosen = heavy_ball(modes_);
    options_.c_F = chosen.c_F;
    options_.c_h = chosen.c_h;
  }

  [[nodiscard]] double largest_movement() const {
    if (options_.policy.limit != force_model::StepLimit::relative) {
      return std::sqrt(proposed_.colwise().squaredNorm().maxCoeff());  // (16)
    }
    double largest = 0;
    for (Eigen::Index i = 0; i + 1 < proposed_.cols(); ++i) {
      // (18); not std::max, which would drop a NaN
      const double squared = (proposed_.col(i) - proposed_.col(i + 1)).squaredNorm();
      if (!(squared <= largest)) largest = squared;
    }
    return std::sqrt(largest);
  }

  void update_damping() {
    long oscillating = 0;
    for (Eigen::Index i = 0; i < proposed_.cols(); ++i) {
      const bool turns = proposed_.col(i).dot(movement_.col(i)) < -rounding_ * rounding_;
      if (turns && turned_back_[i]) ++oscillating;
      turned_back_[i] = turns;
    }
    const double change = options_.c_s_change;
    c_s_ = oscillating > 0 ? c_s_ + change * static_cast<double>(oscillating)
                           : std::max(1.0, c_s_ - change);
  }

  force_model::Rod rod_;
  force_model::StepOptions options_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd forces_;
  Eigen::Matrix3Xd movement_;
  Eigen::Matrix3Xd proposed_;
  Eigen::ArrayXd free_;
  Eigen::ArrayX<bool> turned_back_;
  double c_s_ = 1;
  long steps_ = 0;
  force_model::ModeBounds modes_;
  Eigen::Matrix3Xd block_points_;
  Eigen::Matrix3Xd block_forces_;
  double force_change_ = 0;
  double point_change_ = 0;
  double mode_rounding_ = 0;
  double rounding_ = 0;
  bool has_block_start_ = false;
};

}  // namespace dlo::test
