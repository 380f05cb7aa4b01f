// Tests of the turns of a shape: the solvers' results compared with the turns that the grips hold.

#include <gtest/gtest.h>

#include <numbers>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "solve/held_frames.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

/// Returns a rod without weight between two clamps on one line, of which the second one is rotated.
Scene twisted_scene(double apart, double turns) {
  Scene scene;
  scene.name = "twisted";
  scene.length = 0.8;
  scene.diameter = 4e-3;
  scene.given_bending_stiffness = 2e-3;
  scene.given_mass_per_length = 0;
  scene.torsional_stiffness = 1.5e-3;
  scene.gravity = Eigen::Vector3d::Zero();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  scene.grippers = {{.at = 0, .direction = x, .frame = FrameHold{}},
                    {.at = 0.8,
                     .position = {apart, 0, 0},
                     .direction = x,
                     .frame = FrameHold{.roll = 2 * pi * turns}}};
  return scene;
}

/// At this distance of the ends, the loop that two turns cause has passed through itself.
TEST(Linking, AShapeThatLostTurnsIsNotVerified) {
  Scene scene = twisted_scene(0.4, 2);
  scene.grippers.front().frame->d1 = Eigen::Vector3d::UnitY();
  scene.grippers.back().frame->d1 = Eigen::Vector3d::UnitY();
  for (const Model model : {Model::energy, Model::exact}) {
    try {
      const Solution solution = solve(scene, model, {.time_limit = 300});
      ASSERT_EQ(solution.linking.size(), 1U);
      const Linking& part = solution.linking.front();
      EXPECT_NEAR(part.twist + part.writhe, 2, 0.05) << to_string(model);
    } catch (const ConvergenceError& error) {
      EXPECT_TRUE(has_all(error.what(), {"not verified: the grips hold 2.000 turns"}));
    }
  }
  // Calls turns_mismatch_message() with turns as a solver might return them.
  EXPECT_EQ(turns_mismatch_message({{.end = 1, .held = 2, .twist = 0.9, .writhe = 1.1}}), "");
  EXPECT_NE(turns_mismatch_message({{.end = 1, .held = 2.5, .twist = 0.4, .writhe = 1.1}}), "");
  EXPECT_EQ(
      turns_mismatch_message({{.end = 1, .held = 2, .twist = -1e-14, .writhe = -1e-5}}),
      "not verified: the grips hold 2.000 turns from s = 0 to 1 m and the shape has 0.000 (twist "
      "0.000, writhe 0.000): it has passed through itself");
  EXPECT_TRUE(has_all(turns_mismatch_message({{.end = 1, .held = 1, .twist = 0.1, .writhe = -0.1}}),
                      {"other homotopy class"}));
  EXPECT_NE(turns_mismatch_message({{.end = 1, .held = -1.25, .twist = 0.25, .writhe = 0.51}}), "");
}

// The direction of the last clamp passes the opposite of the first clamp's direction. The
// difference between the turns of the shape and the prescribed ones then jumps by one, and no turn
// is lost.
TEST(Linking, OpposingClampsLoseNoTurns) {
  Scene before = twisted_scene(0.4, 0);
  before.grippers.back().direction = Eigen::Vector3d(-1, 0.1, 0).normalized();
  Scene after = before;
  after.grippers.back().direction = Eigen::Vector3d(-1, -0.1, 0).normalized();
  const std::vector<Linking> was = {{.end = 0.8, .held = 0.1, .twist = 0.3, .writhe = -0.2}};
  const std::vector<Linking> one = {{.end = 0.8, .held = 0.1, .twist = 0.3, .writhe = 0.8}};
  const std::vector<Linking> two = {{.end = 0.8, .held = 0.1, .twist = 0.3, .writhe = 1.8}};
  EXPECT_EQ(turns_mismatch_message(before, was, after, one), "");
  EXPECT_NE(turns_mismatch_message(before, was, before, one), "");
  EXPECT_NE(turns_mismatch_message(before, was, after, two), "");
  EXPECT_NE(turns_mismatch_message(before, was, before, two), "");
  EXPECT_EQ(turns_mismatch_message(before, two, before, two), "");
}

}  // namespace
}  // namespace dlo::compare
