// Tests of polygons of rods with sections and of intrinsically curved rods, against the rod's
// differential equation and against each other.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/chain.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {
namespace {

/// Returns a rod of 1 m, clamped level at arc length 0.
Scene cantilever(double natural_curvature) {
  Scene scene;
  scene.name = "unlike";
  scene.file = "unlike.toml";
  scene.length = 1;
  scene.given_bending_stiffness = 0.2;
  scene.given_mass_per_length = 0.1;
  scene.natural_strain.y() = natural_curvature;
  scene.grippers = {
      {.at = 0, .position = {0, 0, 0}, .direction = Eigen::Vector3d(1, 0, 0), .frame = {}}};
  return scene;
}

std::vector<Section> two_sections() {
  return {{.from = 0.2, .to = 0.45, .bending_stiffness = 0.8, .mass_per_length = 0.4},
          {.from = 0.45, .to = 0.6, .bending_stiffness = 0.1, .mass_per_length = 0.05}};
}

TEST(UnlikeRod, ThePolygonConvergesToTheRodWithSecondOrder) {
  for (const bool sections : {false, true}) {
    for (const double curvature : {0.0, 3.0, -5.0}) {
      Scene scene = cantilever(curvature);
      if (sections) scene.sections = two_sections();
      double first = 0;
      for (const int points : {20, 40, 80, 160}) {
        scene.force_model.points = points;
        const Shape chain = solve(scene, Model::chain).shape;
        const Shape rod = solve(scene, Model::energy, {}, chain.arc_length).shape;
        const double error = (chain.points - rod.points).colwise().norm().maxCoeff();
        if (first == 0) first = error;
        const double expected = first * std::pow(20.0 / points, 2);
        EXPECT_LT(error, 1.05 * expected) << sections << " " << curvature << " " << points;
      }
      EXPECT_LT(first, 0.005);
    }
  }
}

TEST(UnlikeRod, ForceModelAndChainComeToRestInTheSameShape) {
  for (const bool two_clamps : {false, true}) {
    Scene scene = cantilever(3);
    scene.sections = two_sections();
    if (two_clamps) {
      scene.grippers.push_back(
          {.at = 1, .position = {0.7, 0.1, 0}, .direction = Eigen::Vector3d(1, 0, 0), .frame = {}});
    }
    const Solution chain = solve(scene, Model::chain);
    const Solution force = solve(scene, Model::force);
    EXPECT_TRUE(force.neglected.empty());
    // The chain of a scene with a single clamp has inextensible segments.
    const double stretch =
        two_clamps ? 0 : scene.mass() * scene.gravity.norm() / scene.axial_stiffness();
    EXPECT_LT((force.shape.points - chain.shape.points).cwiseAbs().maxCoeff(), 1e-6 + stretch);
    EXPECT_NEAR(force.energy.bending, chain.energy.bending, 1e-3 * chain.energy.bending);
    for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
      EXPECT_LT((force.grippers[i].torque - chain.grippers[i].torque).norm(), 1e-3);
    }
  }
}

TEST(UnlikeRod, CountedFromTheOtherEndIsTheSameRod) {
  for (const Model model : {Model::chain, Model::force}) {
    Scene scene = cantilever(3);
    scene.sections = {{.from = 0, .to = 0.3, .bending_stiffness = 0.8, .mass_per_length = 0.4}};
    Scene reversed = cantilever(-3);
    reversed.sections = {{.from = 0.7, .to = 1, .bending_stiffness = 0.8, .mass_per_length = 0.4}};
    reversed.grippers[0].at = 1;
    reversed.grippers[0].direction = Eigen::Vector3d(-1, 0, 0);
    const Eigen::Matrix3Xd points = solve(scene, model).shape.points;
    const Eigen::Matrix3Xd back = solve(reversed, model).shape.points.rowwise().reverse();
    EXPECT_LT((points - back).cwiseAbs().maxCoeff(), 1e-6) << to_string(model);
  }
}

Scene turned(Scene scene, const Eigen::Matrix3d& R, const Eigen::Vector3d& shift) {
  scene.gravity = R * scene.gravity;
  for (Gripper& gripper : scene.grippers) {
    gripper.position = R * gripper.position + shift;
    gripper.direction = R * *gripper.direction;
    // d2 is the plane's normal; the default would be that on the side of +z.
    gripper.frame = FrameHold{.d1 = R * Eigen::Vector3d(0, 1, 0)};
  }
  return scene;
}

TEST(UnlikeRod, MayLieInAnyPlane) {
  const Scene scene = cantilever(3);
  // d1 = normal x t is to the left of t.
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(0.1, -0.4, 0.7);
  const Scene other = turned(scene, R, shift);
  ASSERT_TRUE(other.planar());
  for (const Model model : {Model::energy, Model::chain, Model::force}) {
    const Solution here = solve(scene, model);
    const Solution there = solve(other, model);
    const Eigen::Matrix3Xd expected = (R * here.shape.points).colwise() + shift;
    EXPECT_LT((there.shape.points - expected).cwiseAbs().maxCoeff(), 1e-6) << to_string(model);
    EXPECT_LT((there.grippers[0].torque - R * here.grippers[0].torque).norm(), 1e-5);
    EXPECT_LT((there.grippers[0].force - R * here.grippers[0].force).norm(), 1e-5);
  }
  EXPECT_THROW((void)discretise(other, other.force_model), InputError);
}

// In space points have no frame that natural curvature could point along.
TEST(UnlikeRod, SaysWhereNaturalCurvatureIsLeftOut) {
  Scene scene = cantilever(3);
  EXPECT_TRUE(solve(scene, Model::chain).neglected.empty());
  scene.natural_strain.x() = 1;
  for (const Model model : {Model::chain, Model::force}) {
    EXPECT_EQ(solve(scene, model).neglected, std::vector<std::string>{"natural curvature"});
  }
  const Plan plan = make_plan(scene);
  EXPECT_GT(plan.bound("natural curvature"), -1);
  EXPECT_TRUE(std::isinf(plan.bound("polygon")));
}

TEST(UnlikeRod, RefusesJointsThatWouldFold) {
  Scene scene = cantilever(80);
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return discretise(scene, scene.force_model); }),
                      {"force_model.points = 16", "5.52 rad", "80 1/m", "points or more"}));
  scene.force_model.points = 59;
  EXPECT_NO_THROW((void)discretise(scene, scene.force_model));
}

TEST(UnlikeRod, WeighsWhatItsSectionsDo) {
  for (const Bookkeeping bookkeeping : {Bookkeeping::paper, Bookkeeping::consistent}) {
    for (const BendingLaw law : {BendingLaw::paper, BendingLaw::hooke}) {
      Scene scene = cantilever(0);
      scene.sections = two_sections();
      scene.force_model.bookkeeping = bookkeeping;
      scene.force_model.law = law;
      const Discretisation polygon = discretise(scene, scene.force_model);
      EXPECT_NEAR(polygon.weights.row(1).sum(), -9.81 * scene.mass(), 1e-12);
      // A joint inside a section is as much stiffer as the section is.
      const force_model::Bending& bending = polygon.rod.bending;
      EXPECT_NEAR(bending.stiffnesses.maxCoeff(), 4 * bending.stiffness, 1e-12 * bending.stiffness);
      EXPECT_NEAR(bending.stiffnesses.minCoeff(), bending.stiffness / 2, 1e-12 * bending.stiffness);
    }
  }
}

TEST(UnlikeRod, TheExampleScenesSolve) {
  for (const std::string name : {"spring_hose", "spliced_cable"}) {
    const Scene scene = load_scene(std::string(DLO_DATA) + "/scenes/" + name + ".toml");
    for (const Model model : {Model::energy, Model::chain, Model::exact, Model::force}) {
      EXPECT_NO_THROW((void)solve(scene, model)) << name << " " << to_string(model);
    }
  }
}

}  // namespace
}  // namespace dlo::compare
