// Tests of rods that clamps twist, in the models `force` and `chain`.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "../../sanitized.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

/// Returns a rod in space between two clamps, of which the later one is rotated by `roll`.
Scene spatial_scene(double roll) {
  Scene scene = heavy_scene(10, 0);
  scene.torsional_stiffness = scene.bending_stiffness() / 1.3;
  scene.grippers[0].direction = Eigen::Vector3d(1, 0.3, 0).normalized();
  scene.grippers.push_back({.at = 1,
                            .position = {0.75, 0.1, 0.1},
                            .direction = Eigen::Vector3d(1, 0, 0.4).normalized()});
  scene.grippers[0].frame.emplace();
  scene.grippers[1].frame = {.d1 = std::nullopt, .roll = roll};
  return scene;
}

TEST(TwistedRod, ForceModelApproachesTheRodInSecondOrder) {
  for (const double roll : {pi, -4.0}) {
    Scene scene = spatial_scene(roll);
    // With this c_c the stretch of segments is negligible.
    scene.force_model.c_c = 10 * scene.axial_stiffness();
    const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
    ASSERT_EQ(rod.twists.size(), 1);
    const SolveOptions options{.time_limit = 300, .rest_tolerance = 1e-8};
    // The steps to rest grow as the square of the points.
    const std::vector<int> sizes =
        test::sanitized ? std::vector<int>{20, 40} : std::vector<int>{20, 40, 80, 160};
    double last_rms = 0;
    double last_twist = 0;
    for (const int points : sizes) {
      scene.force_model.points = points;
      const Solution force = solve_force(scene, scene.force_model, options);
      EXPECT_TRUE(force.neglected.empty());
      ASSERT_EQ(force.twists.size(), 1);
      const Shape& shape = force.shape;
      const double error =
          rms(shape.arc_length, shape.points - rod.sample(shape.arc_length).points);
      const double twist = force.twists[0].angle - rod.twists[0].angle;
      if (last_rms > 0) {
        EXPECT_NEAR(last_rms / error, 4, 0.6) << roll << ", " << points;
        EXPECT_NEAR(last_twist / twist, 4, 0.6) << roll << ", " << points;
      }
      last_rms = error;
      last_twist = twist;
    }
    const double last_size = sizes.back() / 160.0;
    EXPECT_LT(last_rms, 1e-4 / (last_size * last_size));
    EXPECT_LT(std::abs(last_twist), 1e-3 / (last_size * last_size));
  }
}

TEST(TwistedRod, IsTheSameOfChainAndForceModel) {
  const Scene scene = spatial_scene(3);
  const Solution chain = solve(scene, Model::chain);
  const Solution force = solve(scene, Model::force);
  const Solution rod = solve(scene, Model::energy);
  EXPECT_LT((chain.shape.points - force.shape.points).cwiseAbs().maxCoeff(), 1e-6);
  for (const Solution* solution : {&chain, &force}) {
    ASSERT_EQ(solution->twists.size(), 1);
    const energy_model::TwistedPart& part = solution->twists[0];
    EXPECT_EQ(part.begin, 0);
    EXPECT_EQ(part.end, 1);
    EXPECT_NEAR(part.torque, scene.twisting_stiffness() * part.angle, 1e-12);
    EXPECT_NEAR(part.angle, rod.twists[0].angle, 0.03 * rod.twists[0].angle);
    EXPECT_NEAR(solution->energy.twisting, part.torque * part.angle / 2, 1e-12);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(solution->grippers[i].torque.dot(*scene.grippers[i].direction),
                  (i == 0 ? -1 : 1) * part.torque, 0.1 * std::abs(part.torque));
    }
  }
}

TEST(TwistedRod, CountsTurnsOfDirectorsAsTheEnergyModelDoes) {
  Scene scene = spatial_scene(0);
  scene.force_model.points = 40;
  const Eigen::Vector3d first = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d along = *scene.grippers[1].direction;
  const Eigen::Vector3d last = along.unitOrthogonal();
  for (const int turns : {-1, 0, 1}) {
    scene.grippers[0].frame = {.d1 = first, .roll = 0};
    scene.grippers[1].frame = {.d1 = last, .roll = 2 * pi * turns};
    const double rod = solve(scene, Model::energy).twists.at(0).angle;
    const double chain = solve(scene, Model::chain).twists.at(0).angle;
    EXPECT_NEAR(chain, rod, 0.02 + 0.01 * std::abs(rod)) << turns;
  }
}

TEST(TwistedRod, MayHaveThreeFramesSectionsAndAPin) {
  Scene scene = spatial_scene(2);
  scene.force_model.points = 41;
  scene.sections = {{.from = 0.6,
                     .to = 0.8,
                     .bending_stiffness = 2 * scene.bending_stiffness(),
                     .mass_per_length = scene.mass_per_length(),
                     .torsional_stiffness = scene.twisting_stiffness() / 2}};
  const double GJ = scene.twisting_stiffness();
  EXPECT_NEAR(scene.twisting_compliance(0.5, 1), 0.7 / GJ, 1e-12 / GJ);
  scene.grippers.insert(scene.grippers.begin() + 1,
                        {.at = 0.5,
                         .position = {0.4, -0.15, 0.05},
                         .direction = Eigen::Vector3d::UnitX(),
                         .frame = FrameHold{.d1 = std::nullopt, .roll = -1}});
  const Solution rod = solve(scene, Model::energy);
  for (const Model model : {Model::chain, Model::force}) {
    const Solution polygon = solve(scene, model);
    ASSERT_EQ(polygon.twists.size(), 2);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(polygon.twists[i].begin, rod.twists[i].begin);
      EXPECT_NEAR(polygon.twists[i].angle, rod.twists[i].angle, 0.02) << to_string(model);
      EXPECT_NEAR(polygon.twists[i].torque, rod.twists[i].torque, 0.02 * GJ / 0.3);
    }
  }
}

TEST(TwistedRod, FallsFromItsOwnShapeToItself) {
  const Scene scene = spatial_scene(4);
  const Shape shape = solve_chain(scene, scene.force_model).shape;
  const Shape again = chain_from(scene, scene.force_model, shape);
  EXPECT_LT((again.points - shape.points).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace dlo::compare
