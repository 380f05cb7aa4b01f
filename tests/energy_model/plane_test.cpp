#include "dlo/energy_model/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace dlo::energy_model {
namespace {

TEST(Plane, HoldsDirectionAndForces) {
  const Eigen::Vector3d direction(1, 2, -1);
  const Eigen::Vector3d force(0.3, -1, 2);
  const std::optional<Plane> plane = find_plane({1, 1, 1}, direction, {force});
  ASSERT_TRUE(plane);
  EXPECT_LT((plane->vector(plane->coordinates(force)) - force).norm(), 1e-15);
  EXPECT_LT((plane->x - direction.normalized()).norm(), 1e-15);
  EXPECT_LT(std::abs(plane->x.dot(plane->y)), 1e-15);
}

TEST(Plane, DoesNotExistForForcesAcrossEachOther) {
  EXPECT_FALSE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-6}}));
  EXPECT_TRUE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-14}}));
}

TEST(Plane, OfAnUprightRodOpensTowardsX) {
  const std::optional<Plane> plane = find_plane({0, 0, 0}, {0, 1, 0}, {{0, -1, 0}});
  ASSERT_TRUE(plane);
  EXPECT_LT((plane->y - Eigen::Vector3d::UnitX()).norm(), 1e-15);
  const std::optional<Plane> along_x = find_plane({0, 0, 0}, {1, 0, 0}, {});
  ASSERT_TRUE(along_x);
  EXPECT_LT((along_x->y - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

}  // namespace
}  // namespace dlo::energy_model
