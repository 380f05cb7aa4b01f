// Tests of low-pass filtered poses: gain by the closed form, no lag, unchanged lines.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Returns poses from -5 s to 5 s whose x, direction and roll oscillate.
std::vector<Pose> swinging(double frequency, double rate) {
  std::vector<Pose> poses;
  for (int k = 0; k <= 10 * static_cast<int>(rate); ++k) {
    const double t = -5 + k / rate;
    const double angle = 0.1 * std::cos(2 * std::numbers::pi * frequency * t);
    poses.push_back({t,
                     {std::cos(2 * std::numbers::pi * frequency * t), 2 * t + 1, 0},
                     Eigen::Vector3d(std::cos(angle), std::sin(angle), 0),
                     angle});
  }
  return poses;
}

TEST(SmoothPoses, HalveThePowerAtTheCutoffWithoutALag) {
  constexpr double rate = 100;
  constexpr double cutoff = 10;
  for (const double frequency : {1.0, 5.0, 10.0, 20.0, 40.0}) {
    const std::vector<Pose> smooth = smooth_poses(swinging(frequency, rate), cutoff);
    const double ratio =
        std::sin(std::numbers::pi * frequency / rate) / std::sin(std::numbers::pi * cutoff / rate);
    const double gain = 1 / (1 + (std::numbers::sqrt2 - 1) * std::pow(ratio, 4));
    if (frequency == cutoff) EXPECT_NEAR(gain, std::sqrt(0.5), 1e-12);
    // In the middle, far from the ends, whose effect decays within some periods of the cut-off.
    for (std::size_t k = 450; k <= 550; ++k) {
      const double there = std::cos(2 * std::numbers::pi * frequency * smooth[k].time);
      EXPECT_NEAR(smooth[k].position.x(), gain * there, 1e-9);
      EXPECT_NEAR(*smooth[k].roll, 0.1 * gain * there, 1e-9);
      EXPECT_NEAR(smooth[k].direction->norm(), 1, 1e-12);
    }
  }
}

TEST(SmoothPoses, KeepWhatMovesEvenlyAtUnequalSteps) {
  std::vector<Pose> poses;
  for (int k = 0; k < 50; ++k) {
    const double t = 0.02 * k + 0.008 * std::sin(k);
    poses.push_back({t, {3 * t - 1, 2, -t}, std::nullopt, std::nullopt});
  }
  const std::vector<Pose> smooth = smooth_poses(poses, 2);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_LT((smooth[k].position - poses[k].position).norm(), 1e-9);
    EXPECT_EQ(smooth[k].time, poses[k].time);
    EXPECT_FALSE(smooth[k].direction);
  }
}

TEST(SmoothPoses, NeedACutoffBelowHalfTheRate) {
  const std::vector<Pose> poses = swinging(1, 10);
  EXPECT_NO_THROW((void)smooth_poses(poses, 4.9));
  for (const double cutoff : {0.0, -1.0, 5.1, std::nan("")}) {
    EXPECT_THROW((void)smooth_poses(poses, cutoff), std::invalid_argument);
  }
  EXPECT_THROW((void)smooth_poses({poses[0], poses[1]}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::compare
