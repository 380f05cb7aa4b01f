#include "dlo/energy_model/plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace dlo::energy_model {
namespace {

TEST(Plane, DoesNotExistForForcesAcrossEachOther) {
  EXPECT_FALSE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-6}}));
  EXPECT_TRUE(find_plane({0, 0, 0}, {1, 0, 0}, {{0, -1, 0}, {0, 0, 1e-14}}));
}

}  // namespace
}  // namespace dlo::energy_model
