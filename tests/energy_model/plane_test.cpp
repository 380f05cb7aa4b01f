#include "dlo/energy_model/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <optional>

namespace dlo::energy_model {
namespace {

TEST(Plane, DoesNotExistForForcesAcrossEachOther) {
  EXPECT_FALSE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-6}}));
  EXPECT_TRUE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-14}}));
}

TEST(Plane, OfARodAlongXOpensTowardsY) {
  const std::optional<Plane> plane = find_plane({0, 0, 0}, {1, 0, 0}, {});
  ASSERT_TRUE(plane);
  EXPECT_LT((plane->y - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

}  // namespace
}  // namespace dlo::energy_model
