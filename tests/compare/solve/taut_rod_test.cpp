// Tests of rods whose grippers are exactly as far apart as the rod is long, in all models.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {
namespace {

std::string taut_wire(const std::string& gravity) {
  return "gravity = " + gravity + R"(
rod = { length = 1, diameter = "2 mm", material = "spring_steel", torsional_stiffness = 0.2 }
gripper = [{ at = 0, position = [0, 0, 0], direction = [1, 0, 0], roll = 0 },
           { at = 1, position = [1, 0, 0], direction = [1, 0, 0], roll = "1 rad" }]
)";
}

TEST(TautRod, IsStraightAndTwistedInAllModels) {
  const Scene scene = parse_scene(taut_wire("[0, 0, 0]"), "taut.toml");
  for (const Model model : {Model::energy, Model::exact, Model::chain, Model::force}) {
    SCOPED_TRACE(to_string(model));
    const Solution solution = solve(scene, model);
    EXPECT_LT(solution.shape.points.bottomRows<2>().cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(solution.grippers[1].torque.x(), 0.2, 1e-6);
    EXPECT_NEAR(solution.energy.twisting, 0.1, 1e-6);
  }
}

TEST(TautRod, ARefusalOfACoupleNamesIt) {
  const std::string couple = "[[load]]\nat = 0.5\ntorque = [0, 0, 1e-3]\n";
  const Scene scene = parse_scene(taut_wire("[0, 0, 0]") + couple, "taut.toml");
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return solve(scene, Model::exact); }),
                      {"load.torque", "undetermined"}));
}

TEST(TautRod, IsRefusedWhereItsWeightIsAcrossIt) {
  const Scene scene = parse_scene(taut_wire("[0, -9.81, 0]"), "taut.toml");
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return solve(scene, Model::energy); }),
                      {"clamps and forces along it"}));
}

}  // namespace
}  // namespace dlo::compare
