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

namespace {

using dlo::compare::builtin_battery;
using dlo::compare::CardShape;
using dlo::compare::Cause;
using dlo::compare::causes_of;
using dlo::compare::chosen_scenes;
using dlo::compare::Model;
using dlo::compare::moment_balance;
using dlo::compare::Scene;
using dlo::compare::Shape;
using dlo::test::says;

Scene battery_scene(const std::string& id) {
  return chosen_scenes(builtin_battery(), {id})[0].scene;
}

Shape rod_shape(const Scene& scene, int points = 65) {
  return dlo::compare::solve(scene, Model::energy, {},
                             dlo::compare::equal_arc_lengths(scene.length, points))
      .shape;
}

/// Returns the causes for shapes with 16, 32 and 64 segments of another scene.
std::vector<Cause> causes_of_other(const Scene& scene, const Scene& other) {
  std::vector<CardShape> shapes;
  const auto reference = dlo::compare::solve_reference(scene, dlo::compare::answer_model(scene));
  for (const int points : {17, 33, 65}) {
    const Shape shape = rod_shape(other, points);
    shapes.push_back({.points = points,
                      .shape = shape,
                      .error = dlo::compare::distance(shape, reference.sample) / scene.length});
  }
  return causes_of(scene, reference, shapes);
}

TEST(ConvergenceOrder, IsThatOfAPower) {
  EXPECT_NEAR(dlo::compare::convergence_order({{16, {}, 0.04}, {32, {}, 0.01}, {64, {}, 0.0025}}),
              2, 1e-12);
  EXPECT_TRUE(std::isnan(dlo::compare::convergence_order({{16, {}, 0.04}})));
  EXPECT_TRUE(std::isnan(dlo::compare::convergence_order({{16, {}, 0.04}, {64, {}, 1e-12}})));
}

TEST(MomentBalance, HoldsForRodsAtRest) {
  for (const char* id : {"weight_10", "bending_large", "clamps_level", "clamps_space", "end_last",
                         "pin_and_clamp", "payload_tip", "force_across"}) {
    const Scene scene = battery_scene(id);
    const auto balance = moment_balance(scene, rod_shape(scene));
    ASSERT_TRUE(balance) << id;
    EXPECT_LT(balance->imbalance, 5e-3) << id;
    EXPECT_NEAR(balance->stiffness, 1, 0.01) << id;
    EXPECT_NEAR(balance->weight, 1, 0.01) << id;
  }
}

TEST(MomentBalance, TellsStiffnessAndWeight) {
  const Scene scene = battery_scene("payload_tip");
  Scene other = scene;
  other.scale_modulus(2);
  EXPECT_NEAR(moment_balance(scene, rod_shape(other))->stiffness, 2, 0.02);
  other = scene;
  other.scale_density(0.5);
  EXPECT_NEAR(moment_balance(scene, rod_shape(other))->weight, 0.5, 0.01);
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
  // w l (l/64)^2 / EI = Gamma / 64^2, a quarter of it; the shape's EI is found to 1 %.
  const Scene scene = battery_scene("weight_100");
  EXPECT_NEAR(moment_balance(scene, rod_shape(scene))->resolution, 100.0 / 4096 / 4, 1e-4);
}

TEST(Causes, AreNoneOfAnErrorThatIsAThousandthOfWhatIsRight) {
  const Scene scene = battery_scene("weight_10");
  Scene other = scene;
  other.scale_modulus(1 + 1e-5);
  EXPECT_TRUE(causes_of_other(scene, other).empty());
}

TEST(Causes, NameWhatASceneHasAndAShapeHasNot) {
  const Scene hose = battery_scene("curved_hose");
  ASSERT_EQ(causes_of_other(hose, hose.without_natural_strain()).size(), 1U);
  EXPECT_EQ(causes_of_other(hose, hose.without_natural_strain())[0].name,
            "intrinsic curvature ignored");
  const Scene twisted = battery_scene("twist_half_turn");
  EXPECT_EQ(causes_of_other(twisted, twisted.without_twist()).at(0).name, "twist not coupled");
  const Scene strip = battery_scene("strip_oblique");
  Scene round = strip;
  round.given_bending_stiffness_2.reset();
  EXPECT_EQ(causes_of_other(strip, round).at(0).name, "second bending stiffness ignored");
  const Scene floor = battery_scene("floor");
  Scene free = floor;
  free.obstacles.clear();
  EXPECT_EQ(causes_of_other(floor, free).at(0).name, "obstacles ignored");
}

TEST(Causes, NameStretchThatRigidSegmentsDoNotHave) {
  const Scene cord = battery_scene("stretch_bending");
  Scene rigid = cord;
  rigid.stretch = dlo::compare::Stretch::none;
  EXPECT_EQ(causes_of_other(cord, rigid).at(0).name, "stretch ignored");
}

TEST(Causes, NameAStiffnessWhereNoChainIsCompared) {
  const Scene spliced = battery_scene("section_splice");
  Scene soft = spliced;
  soft.scale_modulus(0.6);
  const std::vector<Cause> causes = causes_of_other(spliced, soft);
  ASSERT_EQ(causes.size(), 1U);
  EXPECT_EQ(causes[0].name, "bending stiffness wrong");
  EXPECT_NEAR(causes[0].factor, 0.6, 0.01);
}

// Chains of 7 to 31 segments: the coarsest one's own error is more than a fitted stiffness may
// leave.
TEST(Causes, NameAStiffnessThatCoarseChainsHaveBesideTheirOwnError) {
  for (const char* id : {"section_halves", "payload_within", "weight_100"}) {
    const Scene scene = battery_scene(id);
    const auto reference = dlo::compare::solve_reference(scene, dlo::compare::answer_model(scene));
    std::vector<CardShape> shapes;
    for (const int points : {8, 16, 32}) {
      Scene soft = scene;
      soft.scale_modulus(0.5);
      soft.force_model.points = points;
      const Shape shape = dlo::compare::solve(soft, Model::chain).shape;
      shapes.push_back({.points = points,
                        .shape = shape,
                        .error = dlo::compare::distance(shape, reference.sample) / scene.length});
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
    return dlo::compare::cause_of_factors(scene, {17, coarse}, {65, fine});
  };
  // Factors with 16 and 64 elements.
  const Cause caps = cause(weight, 1 / 1.1, 1 / 1.4);
  EXPECT_EQ(caps.name, "weight with caps");
  EXPECT_NEAR(caps.factor, 1.4, 1e-12);
  // 4 r / (3 h) is 0.4 for h of 0.6 m / 64.
  EXPECT_TRUE(says(caps.words, {"caps of radius 2.81 mm"}));
  EXPECT_NE(cause(battery_scene("payload_tip"), 1 / 1.1, 1 / 1.4).name, "weight with caps");
  EXPECT_EQ(cause(weight, 1.0 / 16, 1.0 / 64).name, "springs without 1/h");
  EXPECT_EQ(cause(weight, 16, 64).name, "springs with 1/h^2");
  EXPECT_EQ(cause(weight, 0.7, 0.7).name, "bending stiffness wrong");
  EXPECT_EQ(cause(weight, 2, 1.2).name, "bending stiffness depends on N");
  EXPECT_EQ(cause(weight, 1e-5, 2e-5).name, "bending stiffness ignored");
}

TEST(Causes, OfTheRodItselfThereAreNone) {
  for (const char* id : {"weight_10", "twist_bending", "floor", "strip_edge_below"}) {
    EXPECT_TRUE(causes_of_other(battery_scene(id), battery_scene(id)).empty()) << id;
  }
}

TEST(OwnPolygon, OfAStraightColumnFitsNoSprings) {
  const Scene column = battery_scene("buckling_below");
  Shape shape = rod_shape(column, 9);
  shape.points.row(0) *= 0.999;
  EXPECT_NO_THROW((void)dlo::compare::own_polygons(column, shape, dlo::compare::Springs::fitted));
}

}  // namespace
