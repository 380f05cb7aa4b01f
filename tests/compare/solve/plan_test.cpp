#include "dlo/compare/plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/energy_problems.hpp"
#include "scene/scene_problem.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

struct PlannedScene {
  const char* name;
  Scene scene;
};

Scene rod_between_pins(double gamma, double apart) {
  Scene scene = heavy_scene(gamma, 0);
  scene.grippers = {{.at = 0.1, .position = {0, 0, 0}}, {.at = 0.9, .position = {apart, 0.1, 0}}};
  return scene;
}

Scene sideways_load() {
  Scene scene = heavy_scene(6, 20);
  scene.loads = {{.at = 0.7, .force = Vector3d(0.3, 0, 4) * scene.bending_stiffness()}};
  return scene;
}

std::vector<PlannedScene> planned_scenes() {
  Scene clamp_inside = heavy_scene(40, 20);
  clamp_inside.grippers[0].at = 0.3;
  return {{"light", heavy_scene(0.1, 0)},
          {"steel", heavy_scene(0.2, -135)},
          {"heavy", heavy_scene(100, 60)},
          {"hanging", heavy_scene(30, -90)},
          {"clamp_inside", clamp_inside},
          {"arch", two_clamps(10, {0.8, 0, 0})},
          {"spatial", two_clamps(5, {0.6, 0.1, 0.2}, {0.5, 0.3, -0.6})},
          {"sideways", sideways_load()},
          {"nearly_taut", rod_between_pins(20, 0.79)}};
}

class PlanOf : public testing::TestWithParam<PlannedScene> {};

/// Returns the equilibrium of the polygon with elastic segments from its first start, also for a
/// single clamp, with which solve_chain() uses rigid segments.
Shape elastic_chain(const Scene& scene, const ForceModelSettings& settings) {
  const Discretisation discretisation = discretise(scene, settings);
  const energy_model::PolygonResult result = energy_model::solve_polygon(
      polygon_problem(discretisation.rod), discretisation.starts.front(), {.tolerance = 1e-14});
  EXPECT_TRUE(energy_model::succeeded(result.status)) << result.message;
  return discretisation.shape(result.points);
}

/// Returns the RMS distance of the chain of a scene from the rod of the energy model [m].
double chain_error(const Scene& scene) {
  const Shape shape = solve_chain(scene, scene.force_model).shape;
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy);
  return rms(shape.arc_length, shape.points - rod.sample(shape.arc_length).points);
}

/// Returns the RMS distance [m] of two polygons with the same arc lengths.
double apart(const Shape& a, const Shape& b) { return rms(a.arc_length, a.points - b.points); }

TEST_P(PlanOf, BoundsWhatStretchDoesToThePolygon) {
  // A larger diameter with a smaller modulus and density increases the effect of stretch at the
  // same EI and Gamma.
  for (const double softer : {1.0, 30.0}) {
    Scene scene = GetParam().scene;
    scene.diameter *= softer;
    scene.material.youngs_modulus /= std::pow(softer, 4);
    scene.material.density /= softer * softer;
    scene.force_model.points = 49;
    ForceModelSettings stiff = scene.force_model;
    stiff.c_c = 1e4 * scene.axial_stiffness();
    scene.force_model.c_c = scene.axial_stiffness();
    const double bound = make_plan(scene).bound("stretch");
    const double measured =
        apart(elastic_chain(scene, stiff), elastic_chain(scene, scene.force_model));

    EXPECT_GE(bound, measured);
    if (measured > 1e-8) EXPECT_LE(bound, 10 * measured);
  }
}

TEST_P(PlanOf, BoundsWhatThePolygonNeglects) {
  for (const int points : {16, 40, 100}) {
    for (const Bookkeeping bookkeeping : {Bookkeeping::consistent, Bookkeeping::paper}) {
      Scene scene = GetParam().scene;
      scene.force_model.points = points;
      scene.force_model.bookkeeping = bookkeeping;
      scene.force_model.c_c = 100 * scene.axial_stiffness();
      const double measured = chain_error(scene);
      const double bound = make_plan(scene).bound("polygon");
      EXPECT_GE(bound, measured) << points << " " << to_string(bookkeeping);
      // The bound is infinite if the first-order response exceeds 3 % of the length.
      if (std::isfinite(bound) && measured > 1e-9) {
        EXPECT_LE(bound, 10 * measured) << points << " " << to_string(bookkeeping);
      }
    }
  }
}

TEST_P(PlanOf, PointsMeetTheTarget) {
  for (const double target : {1e-2, 1e-3, 1e-4}) {
    Scene scene = GetParam().scene;
    const Plan plan = make_plan(scene, {.target = target});
    ASSERT_GT(plan.points, 0);
    scene.force_model.points = plan.points;
    scene.force_model.c_c = 100 * scene.axial_stiffness();
    EXPECT_LE(chain_error(scene), target * scene.length) << plan.points;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlanOf, testing::ValuesIn(planned_scenes()),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(Plan, ShearOfALightCantileverIsTimoshenkos) {
  // Deflection by shear w (l s - s^2/2) / (kGA); its RMS over the rod is w l^2 / (kGA) sqrt(2/15).
  Scene scene = heavy_scene(1e-3, 0);
  const double kGA = 0.3 * scene.axial_stiffness();
  const double w = scene.weight_per_length().norm();
  const double expected = w / kGA * std::sqrt(2.0 / 15);
  EXPECT_NEAR(make_plan(scene).bound("shear") / (2 * expected), 1, 2e-2);
}

TEST(Plan, NoShapeReachesAnObstacleThatIsOutOfReach) {
  for (const PlannedScene& entry : planned_scenes()) {
    for (const double degrees : {0.0, 60.0, 90.0, 150.0, 230.0, 270.0, 310.0}) {
      Scene scene = entry.scene;
      const double angle = degrees * std::numbers::pi / 180;
      const Vector3d normal(std::cos(angle), std::sin(angle), 0);
      scene.obstacles = {{obstacle::Body::half_space(Vector3d::Zero(), normal)}};
      // The half-space is moved to where its clearance in the plan is zero; no shape comes nearer
      // to it.
      const double clearance = obstacle_clearances(scene).front();
      scene.obstacles.front().body = obstacle::Body::half_space(clearance * normal, normal);
      EXPECT_NEAR(obstacle_clearances(scene).front(), 0, 1e-12);
      const energy_model::Equilibrium rod = solve_reference(entry.scene, Model::energy);
      const Eigen::Matrix3Xd points = rod.sample(equal_arc_lengths(1, 101)).points;
      EXPECT_GE(((points.colwise() - scene.obstacles.front().body.centre()).transpose() * normal)
                    .minCoeff(),
                -1e-9)
          << entry.name << " " << degrees;
      EXPECT_TRUE(make_plan(scene).obstacles.front().in_reach);
      scene.obstacles.front().body = scene.obstacles.front().body.enlarged(-0.05);
      EXPECT_FALSE(make_plan(scene).obstacles.front().in_reach);
    }
  }
}

TEST(Plan, TheReachOfARodIsAttained) {
  // A straight rod points at the obstacle: its tip has exactly the clearance of the plan.
  Scene scene = heavy_scene(0, -90);
  scene.obstacles = {{obstacle::Body::half_space({0, -1.5, 0}, Eigen::Vector3d::UnitY())}};
  EXPECT_NEAR(obstacle_clearances(scene).front(), 0.5, 1e-15);
  // A rod folded straight down between two pins: an isosceles triangle.
  scene.grippers = {{.at = 0, .position = {0, 0, 0}}, {.at = 1, .position = {0.6, 0, 0}}};
  EXPECT_NEAR(obstacle_clearances(scene).front(), 1.5 - 0.4, 1e-15);
}

TEST(Plan, TellsPlanarFromSpatialAndListsTheSpans) {
  EXPECT_TRUE(make_plan(heavy_scene(5, 10)).planar);
  EXPECT_FALSE(make_plan(sideways_load()).planar);
  Scene scene = two_clamps(5, {0.8, 0, 0});
  scene.grippers[1].at = 0.8;
  scene.grippers[1].position.x() = 0.65;
  scene.grippers.push_back({.at = 0.5, .position = {0.4, 0, 0}});
  const Plan plan = make_plan(scene);
  ASSERT_EQ(plan.spans.size(), 2U);
  EXPECT_EQ(plan.spans[0].begin_support, "clamp");
  EXPECT_EQ(plan.spans[0].inner_pins, 1);
  EXPECT_EQ(plan.spans[0].end, 0.8);
  EXPECT_EQ(plan.spans[1].end_support, "free");
  scene.obstacles = {{obstacle::Body::half_space({0, -0.1, 0}, {0, 0.8, 0.6})}};
  EXPECT_FALSE(make_plan(scene).planar);
  scene.obstacles.front().body = obstacle::Body::half_space({0, -9, 0}, {0, 0.8, 0.6});
  EXPECT_TRUE(make_plan(scene).planar);
}

TEST(Plan, StretchIsNeededWhereARodIsTaut) {
  EXPECT_FALSE(make_plan(heavy_scene(1, 0)).stretch);
  EXPECT_TRUE(make_plan(rod_between_pins(1e-3, 0.999999 * std::sqrt(0.64 - 0.01))).stretch);
}

TEST(Plan, MotionCountsWhenItsKineticEnergyDoes) {
  const Scene scene = heavy_scene(1, 0);
  EXPECT_FALSE(make_plan(scene).moving);
  EXPECT_FALSE(make_plan(scene, {.gripper_speed = 1e-4}).moving);
  const Plan fast = make_plan(scene, {.gripper_speed = 1});
  EXPECT_TRUE(fast.moving);
  // First modes of a cantilever whose clamp starts at v: the tip's amplitude is
  // v l^2 sqrt(rho A / EI) (1.566/3.516 + 0.868/22.03 + 0.509/61.70 + ...).
  const double unit = std::sqrt(scene.mass() / scene.bending_stiffness());
  EXPECT_GT(fast.bound("inertia"), unit * (1.566 / 3.516 + 0.868 / 22.03 + 0.509 / 61.70));
  EXPECT_LT(fast.bound("inertia"), 1.3 * unit * (1.566 / 3.516));
}

TEST(Plan, NoBoundIsGivenNextToBuckling) {
  // An upright rod buckles at 7.8373; a coarse polygon does before.
  for (const double gamma : {7.6, 7.8}) {
    Scene scene = heavy_scene(gamma, 90);
    scene.force_model.points = 8;
    const Plan plan = make_plan(scene);
    for (const char* what : {"stretch", "shear", "polygon"}) {
      EXPECT_TRUE(std::isinf(plan.bound(what))) << gamma << " " << what;
    }
    EXPECT_EQ(plan.points, 0);
  }
  const Plan far = make_plan(heavy_scene(6, 90));
  EXPECT_LT(far.bound("polygon"), 1e-6);
  EXPECT_GT(far.points, 0);
}

TEST(Plan, BoundsThePolygonOnTheWayToBucklingOrSaysThatItDoesNot) {
  int bounded = 0;
  for (const double gamma : {2.0, 6.0, 7.0, 7.5, 7.8, 8.5}) {
    for (const double degrees : {85.0, 89.0, 89.99}) {
      Scene scene = heavy_scene(gamma, degrees);
      scene.force_model.points = 12;
      const double bound = make_plan(scene).bound("polygon");
      if (std::isinf(bound)) continue;
      ++bounded;
      const double measured = chain_error(scene);
      EXPECT_GE(bound, measured) << gamma << " " << degrees;
      EXPECT_LE(bound, 10 * measured + 1e-9) << gamma << " " << degrees;
    }
  }
  EXPECT_GE(bounded, 6);
}

TEST(Plan, IsMadeInTimeAndNeverFails) {
  Scene scene = heavy_scene(10, 0);
  scene.grippers.push_back({.at = 1, .position = {1.5, 0, 0}});  // out of reach
  const Plan plan = make_plan(scene);
  EXPECT_TRUE(std::isinf(plan.bound("polygon")));
  EXPECT_THROW((void)make_plan(scene, {.time_limit = 0}), std::invalid_argument);
}

TEST(Plan, SaysWhatGrippersTwistAndThatNoPolygonAnswersForIt) {
  Scene scene = two_clamps(5, {0.8, 0, 0});
  EXPECT_FALSE(make_plan(scene).frame_held);
  scene.grippers[1].frame = FrameHold{.d1 = std::nullopt, .roll = 3};
  const Plan alone = make_plan(scene);
  EXPECT_TRUE(alone.frame_held);
  EXPECT_TRUE(alone.twist.empty());
  EXPECT_EQ(alone.bound("twist"), 0);
  scene.torsional_stiffness = scene.bending_stiffness() / 1.3;
  scene.grippers[0].frame = FrameHold{.d1 = std::nullopt, .roll = 1};
  const Plan plan = make_plan(scene);
  ASSERT_EQ(plan.twist.size(), 1U);
  EXPECT_NEAR(plan.twist.front().turn, 2, 1e-12);
  EXPECT_NEAR(plan.twist.front().twist, 1.5, 0.5);
  EXPECT_FALSE(plan.planar);
  EXPECT_NEAR(plan.bound("twist"), 0.1, 0.09);
  EXPECT_TRUE(std::isinf(plan.bound("polygon")));
  EXPECT_EQ(plan.neglected[4].name, "twist");
  EXPECT_EQ(plan.neglected[4].models, "chain, force (law paper only)");
  scene.grippers[1].frame->d1 = Vector3d::UnitY();
  EXPECT_TRUE(std::isnan(make_plan(scene).twist.front().turn));
}

TEST(Plan, StatesWhyTheEnergyModelRefusesAScene) {
  Scene scene = heavy_scene(1, 0);
  scene.drag = energy_model::Drag{.velocity = {0, 1, 0}, .normal = 1};
  EXPECT_NE(make_plan(scene).neglected.front().why.find("medium.velocity"), std::string::npos);
}

TEST(Plan, NoBoundIsGivenWhereTheRodTouches) {
  Scene scene = heavy_scene(20, 0);
  scene.obstacles = {{obstacle::Body::half_space({0, -0.15, 0}, Eigen::Vector3d::UnitY())}};
  const Plan plan = make_plan(scene);
  EXPECT_TRUE(plan.contact);
  EXPECT_EQ(plan.bound("stretch"), std::numeric_limits<double>::infinity());
}

// EI and mass alone do not determine the thickness of the rod.
TEST(Plan, BoundsStretchAndShearOnlyIfTheSectionOrEAIsGiven) {
  Scene scene;
  scene.length = 0.3;
  scene.given_bending_stiffness = 0.2;
  scene.given_mass_per_length = 1.1;
  scene.grippers = {{.at = 0, .position = {0, 0, 0}, .direction = Vector3d::UnitX()}};
  const Plan unknown = make_plan(scene);

  Scene thick = scene;
  thick.diameter = 0.04;
  Scene stiff = scene;
  stiff.given_axial_stiffness = 16 * 0.2 / (0.04 * 0.04);
  for (const char* what : {"stretch", "shear"}) {
    EXPECT_TRUE(std::isinf(unknown.bound(what))) << what;
    EXPECT_GT(make_plan(thick).bound(what), 0) << what;
    EXPECT_NEAR(make_plan(stiff).bound(what), make_plan(thick).bound(what), 1e-12) << what;
  }
  EXPECT_TRUE(std::isfinite(unknown.bound("polygon")));
}

}  // namespace
}  // namespace dlo::compare
