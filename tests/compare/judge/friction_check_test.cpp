#include "dlo/compare/friction_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../says.hpp"
#include "dlo/compare/reference.hpp"
#include "judge/held_polygon.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::heavy_scene;
using test::says;

/// Clamped level above a floor, on which its end lies.
Scene over_floor(double gamma, double height, double friction) {
  Scene scene = heavy_scene(gamma, 0);
  Obstacle floor;
  floor.body = obstacle::Body::half_space({0, -height, 0}, Eigen::Vector3d::UnitY());
  floor.friction = friction;
  scene.obstacles.push_back(floor);
  return scene;
}

ShapeCheck laid(const Scene& scene, const energy_model::Equilibrium& rod, Eigen::Index points) {
  ShapeCheck check;
  check.length_m = scene.length;
  check.alignment.arc_lengths = ArcLengths::file;
  check.alignment.shape.arc_length = equal_arc_lengths(scene.length, points);
  check.alignment.shape.points = rod.sample(check.alignment.shape.arc_length).points;
  return check;
}

/// A rod that is pulled along the floor by a dead force at its end: without that force the same
/// shape needs friction of the same sum, mu = F / N.
struct Pulled {
  ShapeCheck check;
  double needed = 0;
};

Pulled pulled(const Scene& scene, double share_of_weight, Eigen::Index points) {
  Scene with = scene;
  const double force = share_of_weight * with.mass() * with.gravity.norm();
  with.loads.push_back({with.length, {force, 0, 0}});
  const energy_model::Equilibrium rod = solve_reference(with, Model::energy);
  return {laid(scene, rod, points), std::abs(force) / rod.obstacles.front().y()};
}

TEST(FrictionCheck, AShapeThatAForceHeldNeedsThatForceOverWhatTheFloorCarries) {
  for (const double gamma : {100.0, 300.0}) {
    for (const double share : {0.1, 0.2}) {
      const Pulled rod = pulled(over_floor(gamma, 0.05, 0.5), share, 41);
      const FrictionCheck found = check_friction(over_floor(gamma, 0.05, 0.5), rod.check);
      SCOPED_TRACE(testing::Message()
                   << gamma << ", " << share << ": needs " << rod.needed << ", found "
                   << found.coefficient << " +- " << 0.5 * found.factor_error << ", least "
                   << 0.5 * found.least_factor << ", rms " << found.rms_m << ", " << found.reason);
      EXPECT_NEAR(found.coefficient, rod.needed, 0.05 * rod.needed);
      EXPECT_NEAR(found.coefficient, rod.needed, 0.5 * found.factor_error);
      EXPECT_EQ(found.coefficient, 0.5 * found.factor);
      EXPECT_LT(found.rms_m, 1e-4);
    }
  }
}

TEST(FrictionCheck, TellsWhetherTheCoefficientDoes) {
  const Pulled rod = pulled(over_floor(300, 0.05, 0.5), 0.1, 41);
  const auto with = [&](double friction) {
    return check_friction(over_floor(300, 0.05, friction), rod.check).verdict;
  };
  EXPECT_EQ(with(1.4 * rod.needed), FrictionVerdict::inside);
  EXPECT_EQ(with(0.7 * rod.needed), FrictionVerdict::outside);
  // The shape without friction needs none.
  const Scene scene = over_floor(300, 0.05, 0.5);
  const ShapeCheck own = laid(scene, solve_reference(scene, Model::energy), 41);
  EXPECT_EQ(check_friction(scene, own).verdict, FrictionVerdict::none_needed);
}

// What lies on two boards, one after the other: a factor on both says nothing of one coefficient.
TEST(FrictionCheck, TellsACoefficientOnlyWhereAllThatIsTouchedHasTheSame) {
  const Pulled rod = pulled(over_floor(300, 0.05, 0.5), 0.1, 41);
  for (const double of_second : {0.5, 0.3}) {
    Scene scene = over_floor(300, 0.05, 0.5);
    scene.obstacles.clear();
    for (const double middle : {0.2, 1.2}) {
      Obstacle board;
      board.body =
          obstacle::Body::box({middle, -0.15, 0}, Eigen::Matrix3d::Identity(), {1, 0.2, 1}, 0);
      board.friction = middle < 1 ? 0.5 : of_second;
      scene.obstacles.push_back(board);
    }
    const FrictionCheck found = check_friction(scene, rod.check);
    ASSERT_GT(found.factor, 0) << found.reason;
    if (of_second == 0.5) {
      EXPECT_EQ(found.coefficient, 0.5 * found.factor);
      EXPECT_NEAR(found.coefficient, rod.needed, 0.05 * rod.needed);
    } else {
      EXPECT_TRUE(std::isnan(found.coefficient)) << found.coefficient;
    }
  }
}

TEST(FrictionCheck, IsTheSameInSpace) {
  Scene scene = over_floor(300, 0.05, 0.5);
  const Pulled rod = pulled(scene, 0.1, 21);
  Obstacle ball;
  ball.body = obstacle::Body::sphere({0.5, 0.2, 0.4}, 0.1);
  scene.obstacles.push_back(ball);
  ASSERT_FALSE(scene.plane_normal());
  const FrictionCheck found = check_friction(scene, rod.check);
  EXPECT_NEAR(0.5 * found.factor, rod.needed, 0.5 * found.factor_error) << found.reason;
  EXPECT_LT(found.factor_error, 0.3 * found.factor);
}

TEST(FrictionCheck, NoiseDoesNotMakeItSureOfWhatIsWrong) {
  // In the plane, which is quicker.
  const Pulled rod = pulled(over_floor(300, 0.05, 0.5), 0.3, 31);
  for (const double noise : {1e-6, 2e-3}) {
    SCOPED_TRACE(noise);
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, noise);
    ShapeCheck check = rod.check;
    for (double& x : check.alignment.shape.points.topRows<2>().reshaped()) x += normal(random);
    const FrictionVerdict little =
        check_friction(over_floor(300, 0.05, 0.3 * rod.needed), check).verdict;
    const FrictionVerdict enough =
        check_friction(over_floor(300, 0.05, 3 * rod.needed), check).verdict;
    EXPECT_NE(enough, FrictionVerdict::outside);
    EXPECT_NE(little, FrictionVerdict::inside);
    EXPECT_NE(little, FrictionVerdict::none_needed);
    if (noise > 1e-5) continue;
    EXPECT_EQ(enough, FrictionVerdict::inside);
    EXPECT_EQ(little, FrictionVerdict::outside);
  }
}

TEST(FrictionCheck, SaysWhatItCannotTell) {
  const Scene scene = over_floor(300, 0.05, 0.5);
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  ShapeCheck check = laid(scene, rod, 81);
  const auto expect_untold = [&](const Scene& of, const ShapeCheck& shape, const char* why) {
    const FrictionCheck found = check_friction(of, shape);
    EXPECT_EQ(found.verdict, FrictionVerdict::not_identified);
    EXPECT_TRUE(says(found.reason, {why}));
    EXPECT_TRUE(std::isnan(found.factor));
  };
  Scene curved = scene;
  curved.natural_strain = {0, 1, 0};
  expect_untold(curved, check, "axes of its own");
  Scene soft = scene;
  soft.obstacles.front().stiffness = 1e4;
  expect_untold(soft, check, "yields");
  Scene above = scene;
  above.obstacles.front().body = obstacle::Body::half_space({0, -0.5, 0}, Eigen::Vector3d::UnitY());
  expect_untold(above, check, "touches no obstacle");
  // No equilibrium of this rod: a straight one that hovers and comes down on the floor.
  ShapeCheck hovers = check;
  for (Eigen::Index m = 0; m < 81; ++m) {
    hovers.alignment.shape.points.col(m) << 0.0125 * static_cast<double>(m), 0, 0;
  }
  hovers.alignment.shape.points.col(80).y() = -0.05;
  const FrictionCheck of_hovering = check_friction(scene, hovers);
  EXPECT_EQ(of_hovering.verdict, FrictionVerdict::not_identified) << of_hovering.factor;
  check.alignment.arc_lengths = ArcLengths::nearest;
  expect_untold(scene, check, "nearest");
}

TEST(HeldPolygon, ComesToTheRodWithTheSquareOfItsSegments) {
  const Scene scene = heavy_scene(20, 30);
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  double last = 0;
  for (const int segments : {16, 32, 64}) {
    HeldPolygon polygon(scene, segments, std::nullopt);
    polygon.lay_along(rod.sample(polygon.arc_lengths()).points);
    double turned = 1;
    for (int i = 0; i < 20 && turned > 1e-12; ++i) {
      polygon.linearise({});
      turned = polygon.move(polygon.free_step());
    }
    EXPECT_LT(turned, 1e-12);
    const double error = (polygon.nodes() - rod.sample(polygon.arc_lengths()).points).norm() /
                         std::sqrt(static_cast<double>(segments));
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.4);
    }
    last = error;
  }
  EXPECT_LT(last, 1e-3);
}

}  // namespace
}  // namespace dlo::compare
