// Tests of scenes that use the file of a calibration.

#include "dlo/compare/calibrated_rod.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"
#include "dlo/compare/error.hpp"
#include "scene_text.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

std::string refusal(const std::string& text, const Scene& scene = heavy_scene(10, 0)) {
  return error_of<InputError>(
      [&] { return calibrated_scene(scene, parse_calibrated_rod(text, "found.toml")); });
}

TEST(CalibratedRod, ReplacesWhatTheSceneSays) {
  Scene scene = heavy_scene(10, 30);
  scene.given_bending_stiffness = 2;
  scene.given_mass_per_length = 1;
  const CalibratedRod rod = parse_calibrated_rod(
      "bending_stiffness = \"3 N m^2\"\nmass_per_length = 2\n"
      "natural_curvature = [[0, 1], [0, -2]]\n[[gripper]]\nnumber = 1\n"
      "rotation = [0, 0, \"15 deg\"]\ndisplacement = [\"1 mm\", 0, 0]\n",
      "found.toml");
  const Scene found = calibrated_scene(scene, rod);
  EXPECT_DOUBLE_EQ(found.bending_stiffness(), 3);
  EXPECT_DOUBLE_EQ(found.mass_per_length(), 2);
  EXPECT_EQ(found.natural_strain.y(), 1);
  ASSERT_EQ(found.natural_variation.size(), 1U);
  EXPECT_EQ(found.natural_variation[0].y(), -2);
  EXPECT_NEAR(found.grippers[0].direction->y(), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(found.grippers[0].position.x(), 0.001, 1e-18);
}

TEST(CalibratedRod, RefusesWhatItCannotReplace) {
  EXPECT_EQ(refusal("natural_curvature = 1\n"),
            "found.toml: neither a [[material]] nor bending_stiffness (allowed: what dlo calibrate "
            "-o writes)");
  const std::string material =
      "[[material]]\nname = \"calibrated\"\nyoungs_modulus = 1e9\ndensity = 1000\n";
  EXPECT_EQ(refusal(material), "no error");
  EXPECT_EQ(refusal(material + "[[gripper]]\nnumber = 2\nrotation = [0, 0, 1]\n"),
            "heavy.toml: gripper 2 is corrected (allowed: 1 to 1, as many as the scene has)");
  EXPECT_EQ(refusal("bending_stiffness = 1\nmass_per_length = 1\n"),
            "heavy.toml: the rod is given by E, the calibrated one by EI (allowed: both alike)");
  EXPECT_TRUE(has_all(refusal("bending_stiffnes = 1\n"), {"bending_stiffnes"}));
  EXPECT_TRUE(has_all(refusal("damping = -0.01\n" + material), {"found.toml:1: damping", ">= 0"}));
}

class CalibratedCommand : public Command {
 protected:
  /// Writes a scene file and returns its path.
  std::string wire(const std::string& name, const std::string& EI, const std::string& rod,
                   double direction) {
    return write(name, "[rod]\nlength = 1\nmass_per_length = 0.05\nbending_stiffness = " + EI +
                           "\n" + rod +
                           gripper_text(fmt::format("direction = \"{} deg\"", direction)));
  }
};

/// Two shapes whose clamp points 8 degrees off determine a rod and a clamp error, which predict a
/// third shape to an RMS of 1e-5 m.
TEST_F(CalibratedCommand, AHoldOutShapeIsPredicted) {
  std::string scenes;
  for (const std::string direction : {"-40", "10", "50"}) {
    const double degrees = std::stod(direction);
    const std::string truth = wire("truth", "0.03", "natural_curvature = 0.7\n", degrees + 8);
    succeeds("solve " + truth + " --samples 30 --format csv -o " + path(direction + ".csv"));
    scenes += " " + wire("said" + direction, "0.05", "", degrees);
  }
  const std::string shapes = " --shape " + path("-40.csv") + " " + path("10.csv");
  const std::string held_out = " --holdout " + path("50.csv");
  const std::string options = " --natural-curvature 1 --clamp-angles \"20 deg\" --same-clamps";
  const auto found = json_of("calibrate" + scenes + shapes + held_out + options).at("held_out");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at("file"), path("50.csv"));
  EXPECT_LT(found[0].at("rms_m").get<double>(), 1e-5);
  expect_error("calibrate" + scenes + " --shape " + path("10.csv") + held_out, 2,
               {"3 scenes, 1 shapes and 1 held out"});
}

}  // namespace
}  // namespace dlo::compare
