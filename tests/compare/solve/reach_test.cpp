#include <gtest/gtest.h>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "scene/scene_problem.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Returns the scene with a floor and a tilted wall that no point of a rod of length 1 reaches.
Scene with_obstacles_out_of_reach(Scene scene) {
  scene.obstacles.push_back({obstacle::Body::half_space({0, -100, 0}, Eigen::Vector3d::UnitY())});
  scene.obstacles.push_back({obstacle::Body::half_space({-50, 0, 0}, {3, 1, 2}), 1000});
  return scene;
}

Scene between_pins() {
  Scene scene = heavy_scene(8, 0);
  scene.grippers = {{.at = 0, .position = {0, 0, 0}}, {.at = 1, .position = {0.8, 0.1, 0}}};
  return scene;
}

// With obstacles out of reach every model returns the same numbers after the same number of
// evaluations as without them.
TEST(Reach, EveryModelLeavesFarObstaclesOut) {
  for (Scene scene : {heavy_scene(8, 0), between_pins()}) {
    scene.force_model.points = 12;
    const Scene among = with_obstacles_out_of_reach(scene);
    ASSERT_TRUE(obstacles_in_reach(among).empty());
    EXPECT_EQ(among.planar(), scene.planar());
    for (const Model model : {Model::energy, Model::exact, Model::chain, Model::force}) {
      SCOPED_TRACE(to_string(model));
      const Solution alone = solve(scene, model);
      const Solution solution = solve(among, model);
      EXPECT_EQ(solution.shape.points, alone.shape.points);
      EXPECT_EQ(solution.evaluations, alone.evaluations);
      EXPECT_EQ(solution.steps, alone.steps);
      EXPECT_EQ(solution.obstacles, std::vector<Vector3d>(2, Vector3d::Zero()));
    }
  }
}

// Results of an obstacle in reach have its index among all obstacles of the scene.
TEST(Reach, ForcesAreInTheScenesOrder) {
  Scene scene = heavy_scene(30, 0);
  scene.obstacles = {{obstacle::Body::half_space({0, -100, 0}, Eigen::Vector3d::UnitY())},
                     {obstacle::Body::half_space({0, -0.3, 0}, Eigen::Vector3d::UnitY()), 1e4}};
  ASSERT_EQ(obstacles_in_reach(scene), std::vector<std::size_t>{1});
  for (const Model model : {Model::energy, Model::chain, Model::force}) {
    const Solution solution = solve(scene, model);
    ASSERT_EQ(solution.obstacles.size(), 2U);
    EXPECT_EQ(solution.obstacles[0], Vector3d::Zero());
    EXPECT_GT(solution.obstacles[1].y(), 0);
  }
}

// A soft rod stretches further than a stiff one.
TEST(Reach, TheSettingsStretchCounts) {
  Scene scene = heavy_scene(30, 0);
  scene.obstacles = {{obstacle::Body::half_space({0, -1.2, 0}, Eigen::Vector3d::UnitY())}};
  EXPECT_TRUE(obstacles_in_reach(scene).empty());
  ForceModelSettings soft = scene.force_model;
  soft.c_c = scene.weight_per_length().norm();
  EXPECT_EQ(obstacles_in_reach(scene, soft), std::vector<std::size_t>{0});
  EXPECT_EQ(discretise(scene, soft).rod.walls.size(), 1U);
}

// The third obstacle is a floor so near that a softer rod would reach it by stretching.
TEST(Reach, CheckAndCalibrateLeaveThemOutForEveryModulus) {
  const Scene scene = heavy_scene(8, 0);
  Scene among = with_obstacles_out_of_reach(scene);
  among.obstacles.push_back(
      {obstacle::Body::half_space({0, -1.0001, 0}, Eigen::Vector3d::UnitY())});
  const Solution solution = solve(scene, Model::energy);
  const MeasuredShape shape{
      .file = "own", .points = solution.shape.points, .arc_length = solution.shape.arc_length};
  const ShapeCheck check = check_shape(scene, shape);
  const ShapeCheck among_check = check_shape(among, shape);
  EXPECT_EQ(among_check.deviation.rms_m, check.deviation.rms_m);
  EXPECT_EQ(among_check.effective_modulus.solves, check.effective_modulus.solves);
  EXPECT_EQ(fit_material({among}, {shape}).evaluations, fit_material({scene}, {shape}).evaluations);
}

}  // namespace
}  // namespace dlo::compare
