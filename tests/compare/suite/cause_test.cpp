// Tests of the parts of a results table: order of convergence, balance of moments, causes.

#include "suite/cause.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solve.hpp"
#include "explain/own_polygon.hpp"
#include "suite/answer.hpp"
#include "suite/battery.hpp"

namespace dlo::compare {
namespace {

Scene battery_scene(const std::string& id) {
  return chosen_scenes(builtin_battery(), {id})[0].scene;
}

Shape rod_shape(const Scene& scene, int points = 65) {
  return solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, points)).shape;
}

/// Returns the causes for shapes with 16, 32 and 64 segments of another scene.
std::vector<Cause> causes_for_shapes_of(const Scene& scene, const Scene& other) {
  std::vector<CardShape> shapes;
  const auto reference = solve_reference(scene, answer_model(scene));
  for (const int points : {17, 33, 65}) {
    const Shape shape = rod_shape(other, points);
    shapes.push_back({.points = points,
                      .shape = shape,
                      .error = distance(shape, reference.sample) / scene.length});
  }
  return causes_of(scene, reference, shapes);
}

TEST(ConvergenceOrder, IsThatOfAPower) {
  EXPECT_NEAR(convergence_order({{16, {}, 0.04}, {32, {}, 0.01}, {64, {}, 0.0025}}), 2, 1e-12);
  EXPECT_TRUE(std::isnan(convergence_order({{16, {}, 0.04}})));
  EXPECT_TRUE(std::isnan(convergence_order({{16, {}, 0.04}, {64, {}, 1e-12}})));
}

TEST(MomentBalance, DoesNotHoldHalfWayToRest) {
  const Scene scene = battery_scene("clamps_step");
  Shape shape = rod_shape(scene);
  const Shape end = rod_shape(battery_scene("clamps_level"));
  shape.points.row(1) += 0.02 * (shape.points.row(0).array() * 30).sin().matrix();
  EXPECT_GT(moment_balance(scene, shape)->imbalance, 0.1);
  EXPECT_FALSE(moment_balance(battery_scene("floor"), end));
}

// Points farther apart than the boundary layer in which a soft rod bends at its clamp do not
// determine its moments.
TEST(MomentBalance, OfARodAtRestIsWithinItsResolution) {
  for (const char* id : {"weight_100", "weight_1000", "weight_10000", "end_up"}) {
    const Scene scene = battery_scene(id);
    for (const int points : {9, 17, 33, 65}) {
      const auto balance = moment_balance(scene, rod_shape(scene, points));
      ASSERT_TRUE(balance) << id;
      EXPECT_LT(balance->imbalance, std::max(0.02, balance->resolution)) << id << ' ' << points;
    }
  }
  // The resolution is a quarter of w l (l/64)^2 / EI = Gamma / 64^2, within 2 % because EI is
  // estimated from the shape.
  const Scene scene = battery_scene("weight_100");
  EXPECT_NEAR(moment_balance(scene, rod_shape(scene))->resolution, 100.0 / 4096 / 4, 1e-4);
}

TEST(Causes, AreNoneOfAnErrorThatIsAThousandthOfWhatIsRight) {
  const Scene scene = battery_scene("weight_10");
  Scene other = scene;
  other.scale_modulus(1 + 1e-5);
  EXPECT_TRUE(causes_for_shapes_of(scene, other).empty());
}

TEST(Causes, NameWhatASceneHasAndAShapeHasNot) {
  const auto expect_cause = [](const std::string& id, const auto& change, const std::string& name) {
    const Scene scene = battery_scene(id);
    Scene other = scene;
    change(other);
    const std::vector<Cause> causes = causes_for_shapes_of(scene, other);
    ASSERT_FALSE(causes.empty()) << id;
    EXPECT_EQ(causes[0].name, name) << id;
  };
  expect_cause(
      "curved_hose", [](Scene& s) { s = s.without_natural_strain(); },
      "intrinsic curvature ignored");
  expect_cause(
      "twist_half_turn", [](Scene& s) { s = s.without_twist(); }, "twist not coupled");
  expect_cause(
      "strip_oblique", [](Scene& s) { s.given_bending_stiffness_2.reset(); },
      "second bending stiffness ignored");
  expect_cause(
      "floor", [](Scene& s) { s.obstacles.clear(); }, "obstacles ignored");
  expect_cause(
      "stretch_bending", [](Scene& s) { s.stretch = Stretch::none; }, "stretch ignored");
  expect_cause(
      "section_splice", [](Scene& s) { s.scale_modulus(0.6); }, "bending stiffness wrong");
}

// Chains of 7 to 31 segments. The discretisation error of the coarsest exceeds the largest error
// that may remain with a fitted stiffness.
TEST(Causes, NameAStiffnessThatCoarseChainsHaveBesideTheirOwnError) {
  for (const char* id : {"section_halves", "payload_within", "weight_100"}) {
    const Scene scene = battery_scene(id);
    const auto reference = solve_reference(scene, answer_model(scene));
    std::vector<CardShape> shapes;
    for (const int points : {8, 16, 32}) {
      Scene soft = scene;
      soft.scale_modulus(0.5);
      soft.force_model.points = points;
      const Shape shape = solve(soft, Model::chain).shape;
      shapes.push_back({.points = points,
                        .shape = shape,
                        .error = distance(shape, reference.sample) / scene.length});
    }
    const std::vector<Cause> causes = causes_of(scene, reference, shapes);
    ASSERT_EQ(causes.size(), 1U) << id;
    EXPECT_EQ(causes[0].name, "bending stiffness wrong") << id;
    EXPECT_NEAR(causes[0].factor, 0.5, 0.01) << id;
  }
}

TEST(CauseOfFactors, IsWhatTheyAreAtBothNumbersOfPoints) {
  const Scene weight = battery_scene("weight_10");
  const auto cause = [](const Scene& scene, double coarse, double fine) {
    return cause_of_factors(scene, {17, coarse}, {65, fine});
  };
  // The fitted factors are 1.1 with 16 elements and 1.4 with 64.
  const Cause caps = cause(weight, 1 / 1.1, 1 / 1.4);
  EXPECT_EQ(caps.name, "weight with caps");
  EXPECT_NEAR(caps.factor, 1.4, 1e-12);
  // 4 r / (3 h) is 0.4 for h of 0.6 m / 64.
  EXPECT_TRUE(has_all(caps.words, {"caps of radius 2.81 mm"}));
  EXPECT_NE(cause(battery_scene("payload_tip"), 1 / 1.1, 1 / 1.4).name, "weight with caps");
  EXPECT_EQ(cause(weight, 1.0 / 16, 1.0 / 64).name, "springs without 1/h");
  EXPECT_EQ(cause(weight, 16, 64).name, "springs with 1/h^2");
  EXPECT_EQ(cause(weight, 0.7, 0.7).name, "bending stiffness wrong");
  EXPECT_EQ(cause(weight, 2, 1.2).name, "bending stiffness depends on N");
  EXPECT_EQ(cause(weight, 1e-5, 2e-5).name, "bending stiffness ignored");
}

TEST(OwnPolygon, OfAStraightColumnFitsNoSprings) {
  const Scene column = battery_scene("buckling_below");
  Shape shape = rod_shape(column, 9);
  shape.points.row(0) *= 0.999;
  EXPECT_NO_THROW((void)candidate_chains(column, shape, Springs::fitted));
}

}  // namespace
}  // namespace dlo::compare
