// Tests that an option has the same effect as the key of the same name in the scene's file.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string short_rod =
    "gravity = [0, -9.81, 0]\n" + steel_rod + level_clamp + R"([force_model]
points = 8
c_c = 660
)";

class SceneOptions : public Command {
 protected:
  /// Returns the JSON of `dlo solve`, without times, for a rod with given keys in [force_model] and
  /// given options.
  json solved(const std::string& keys, const std::string& options) {
    const std::string result =
        output_of(words({"solve", scene(short_rod + keys), "--format json", options}));
    json document = json::parse(result, nullptr, false);
    if (document.is_object()) document["solver"].erase("wall_s");
    return document;
  }

  void expect_same(const std::string& keys, const std::string& options, const std::string& model) {
    const std::string solver = "--model " + model + " ";
    const json by_option = solved("", solver + options);
    EXPECT_EQ(by_option, solved(keys, solver)) << options;
    EXPECT_NE(by_option, solved("", solver)) << options << " has no effect";
  }
};

TEST_F(SceneOptions, OfThePapersLawMeanTheirKeys) {
  expect_same("law = \"paper\"\nc_b = 3000\n", "--law paper --c-b '3 kN'", "chain");
  expect_same("law = \"paper\"\nc_b = 3000\nbookkeeping = \"paper\"\n",
              "--law paper --c-b 3000 --bookkeeping paper", "chain");
  expect_same("law = \"paper\"\ndesign_curvature = 5\n",
              "--law paper --design-curvature '0.005 1/mm'", "chain");
  const std::string moment = "--law paper --design-curvature 5 --bending-rule moment_matched";
  expect_same("law = \"paper\"\ndesign_curvature = 5\nbending_rule = \"moment_matched\"\n", moment,
              "chain");
  EXPECT_NE(solved("", "--model chain " + moment),
            solved("", "--model chain --law paper --design-curvature 5"));
}

TEST_F(SceneOptions, OfTheStepperMeanTheirKeys) {
  expect_same("stepper = \"dynamic\"\nc_F = 4e-5\nc_h = 0.9\nl_s = 0.02\n",
              "--stepper dynamic --c-F 4e-5 --c-h 0.9 --l-s '2 cm'", "force");
  const std::string dynamic = "--model force --stepper dynamic --c-F 4e-5 --l-s 0.02 --c-h ";
  EXPECT_NE(solved("", dynamic + "0.9"), solved("", dynamic + "0.8"));
  const std::string file = scene(short_rod);
  expect_error("solve " + file + " --model force --stepper dynamic --c-F 4e-5 --c-h 1", 2,
               {"--c-h: 1: out of range", "0 <= value < 1"});
  expect_error("solve " + file + " --law paper --c-b -3", 2, {"--c-b: -3", "> 0"});
  expect_error("solve " + file + " --model force --c-h 0.9", 2, {"c_h", "stepper dynamic"});
}

TEST_F(SceneOptions, OfTheSolversDoWhatTheySay) {
  const auto steps = [&](const std::string& tolerance) {
    return solved("", "--model force --rest-tolerance " + tolerance).at("solver").at("steps");
  };
  EXPECT_LT(steps("1e-3").get<long>(), steps("1e-9").get<long>());
  const auto terms = [&](const std::string& count) {
    return solved("", "--terms " + count).at("solver").at("terms").get<int>();
  };
  EXPECT_EQ(terms("5"), 5);
  EXPECT_EQ(terms("9"), 9);
  expect_error("solve " + steel() + " --all --model chain", 2, {"--all", "energy"});
}

TEST_F(SceneOptions, ATimeThatLeavesNothingButASaddleIsNoSuccess) {
  const std::string twisted = scene(R"(gravity = [0, 0, 0]
rod = { length = 0.2, diameter = "0.4 mm", material = "spring_steel", torsional_stiffness = 1.2e-3 }
gripper = [{ at = 0, position = [0, -0.02, 0], hold = "pin" },
           { at = 0.05, position = [0.01, -0.045, 0.006], direction = [0.3, 0.9, 1.4], roll = 2.4 },
           { at = 0.14, position = [0.09, -0.08, 0.022], direction = [-0.7, -1.1, 1.2], roll = 5.5 }]
load = [{ at = 0.12, force = [-4e-3, 6e-3, 5e-3] }]
)");
  for (const std::string limit : {"0.001", "0.01", "0.1", "0.3"}) {
    const RunResult found =
        run("solve " + twisted + std::string(" --all --format json --time-limit ").append(limit));
    const bool converged = !found.out.empty() && json::parse(found.out).at("converged").get<bool>();
    EXPECT_EQ(found.status, converged ? 0 : 3) << limit << found.err;
  }
}

}  // namespace
}  // namespace dlo::compare
