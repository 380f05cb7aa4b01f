#include "dlo/force_model/environment.hpp"

#include <gtest/gtest.h>

#include "dlo/force_model/grip.hpp"

namespace dlo::force_model {
namespace {

TEST(Wall, PushesBehindThePlaneAndNeverPulls) {
  const Wall wall{.point = {0, 1, 0}, .normal = {0, 1, 0}, .stiffness = 40};
  EXPECT_EQ(wall_force(wall, {5, 0.9, 2}), Eigen::Vector3d(0, 40 * (1 - 0.9), 0));
  EXPECT_EQ(wall_force(wall, {5, 1.1, 2}), Eigen::Vector3d::Zero());
  EXPECT_DOUBLE_EQ(wall_energy(wall, {0, 0.5, 0}), 40 * 0.25 / 2);
  EXPECT_EQ(wall_energy(wall, {0, 1.5, 0}), 0);
}

TEST(Spring, PullsTowardsItsAnchor) {
  EXPECT_EQ(spring_force(3, {1, 0, 0}, {0, 2, 0}), Eigen::Vector3d(3, -6, 0));
}

TEST(Grip, HoldsTwoPointsAlongItsDirection) {
  const Eigen::Matrix3Xd targets = grip_targets({1, 0, 0}, {0, 2, 0}, 0.4, 0.1);
  EXPECT_LT((targets.col(0) - Eigen::Vector3d(1, -0.1, 0)).norm(), 1e-16);
  EXPECT_LT((targets.col(1) - Eigen::Vector3d(1, 0.3, 0)).norm(), 1e-16);
  EXPECT_THROW((void)grip_targets({0, 0, 0}, {0, 0, 0}, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)grip_targets({0, 0, 0}, {1, 0, 0}, -1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::force_model
