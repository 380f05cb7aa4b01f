// Tests of option values: no number may be NaN, and errors name the option.

#include <gtest/gtest.h>

#include <string>

#include "command_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

TEST_F(Command, NumbersOfOptionsAreInTheirRange) {
  const std::string solve = words({"solve", steel(), "--model force"});
  for (const std::string value : {"nan", "inf", "-1", "0", "1e10", "1e-400", "1e400", "1,5", "x"}) {
    expect_error(words({solve, "--time-limit", value}), 2,
                 {"--time-limit", value, "0.001 to 1e+09"});
  }
  for (const std::string value : {"nan", "inf", "0", "0.2", "unit"}) {
    expect_error(words({solve, "--rest-tolerance", value}), 2,
                 {"--rest-tolerance", value, "1e-12 to 0.1"});
  }
  expect_error("bench " + steel() + " --seconds nan", 2, {"--seconds", "nan", "0.1 to 86400"});
  expect_error(solve + "--target-error nan", 2, {"--target-error", "nan", "0.1% or 0.001"});
  expect_error(solve + "--target-error 0,1%", 2, {"--target-error", "comma"});
  expect_error(solve + "--c-c nan", 2, {"--c-c", "nan", "not finite"});
  expect_error("solve " + steel() + " --samples 1000001", 2, {"--samples", "2 to 1000000"});
}

const std::string rod_of = "gravity = [0, -9.81, 0]\n" + steel_rod + level_clamp;

TEST_F(Command, ContradictoryGripsNameFileLineAndKeyWithEveryModel) {
  const auto with_pin = [&](const std::string& at, const std::string& x) {
    return scene(rod_of +
                 ("[[gripper]]\nat = " + at + "\nposition = [" + x + ", 0, 0]\nhold = \"pin\"\n"));
  };
  for (const std::string model : {"energy", "exact", "chain", "force"}) {
    expect_error("solve " + with_pin("0.5", "0.6") + " --model " + model, 2,
                 {"scene.toml:10: gripper.position", "0.6 m from the gripper at = 0 m",
                  "the 0.5 m of rod between them"});
    expect_error("solve " + with_pin("0", "0.1") + " --model " + model, 2,
                 {"scene.toml:10: gripper.at", "two grippers hold this arc length"});
  }
  // The distance of the grippers equals the rod's length, which is too far for a rod that does not
  // stretch.
  const std::string taut = with_pin("0.5", "0.5");
  expect_error("solve " + taut, 2,
               {"scene.toml:10: gripper.position", "less than the 0.5 m", "chain and force"});
  succeeds("solve " + taut + " --model chain");
}

TEST_F(Command, RodsBeyondTheLimitsNameFileLineAndKey) {
  const auto rod = [&](const std::string& from, const std::string& to) {
    return scene(replaced(rod_of, from, to));
  };
  expect_error("solve " + rod("\"50 cm\"", "1e5"), 2,
               {"scene.toml:3: rod.length = 100000", "Gamma", "(allowed: 0 to 1e+12)"});
  expect_error("solve " + rod("\"2 mm\"\nmaterial = \"spring_steel\"",
                              "1000\nmaterial = { youngs_modulus = 1e300, density = 0 }"),
               2, {"scene.toml:5: rod.material", "E I = inf", "finite"});
}

TEST_F(Command, NumbersThatOverflowInSquaresNameFileLineAndKey) {
  expect_error("solve " + scene(rod_of + "[[load]]\nat = 0.5\nmass = 1e200\n"), 2,
               {"scene.toml:12: load.mass = 1e+200: out of range", "up to 1e+30"});
  const std::string curved = replaced(rod_of, "[rod]\n", "[rod]\nnatural_curvature = -1e10\n");
  expect_error("solve " + scene(curved), 2,
               {"scene.toml:3: rod.natural_curvature = -10000000000: out of range", "up to 1e+09"});
}

TEST_F(Command, MessagesShortenValuesOfAMegabyte) {
  const std::string text(1'000'000, 'x');
  const RunResult outcome = run("solve " + scene("[rod]\nlength = \"" + text + "\"\n"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_LT(outcome.err.size(), 2000U);
  EXPECT_TRUE(
      has_all(outcome.err, {"scene.toml:2: rod.length", "bytes)", "(allowed: m, cm, mm, um)"}));
}

TEST_F(Command, AModelThatDoesNotTakeASceneSaysWhichDoes) {
  const std::string ball = scene(std::string(rod_of) +
                                 "[[obstacle]]\nshape = \"sphere\"\npoint = [0, -0.2, "
                                 "0]\nradius = 0.1\nstiffness = 100\n");
  expect_error("solve " + ball + " --model exact", 2,
               {"scene.toml", "obstacle", "--model energy, chain or force"});
  const std::string file = scene(replaced(rod_of, "\"50 cm\"", "1000"));
  expect_error("solve " + file + " --model exact", 2,
               {"scene.toml: rod: model exact", "must be <= 1e6"});
  EXPECT_TRUE(has_none(run("solve " + file + " --model exact").err, {"solve_exact"}));
}

}  // namespace
}  // namespace dlo::compare
