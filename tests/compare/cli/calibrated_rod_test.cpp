// Tests of scenes that use the file of a calibration.

#include "dlo/compare/calibrated_rod.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/error.hpp"
#include "scenes.hpp"

namespace {

using namespace dlo::compare;
using dlo::test::error_of;
using dlo::test::says;

std::string refusal(const std::string& text, const Scene& scene = dlo::test::heavy_scene(10, 0)) {
  return error_of<InputError>(
      [&] { return calibrated_scene(scene, parse_calibrated_rod(text, "found.toml")); });
}

TEST(CalibratedRod, ReplacesWhatTheSceneSays) {
  Scene scene = dlo::test::heavy_scene(10, 30);
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
  EXPECT_TRUE(says(refusal("bending_stiffnes = 1\n"), {"bending_stiffnes"}));
  EXPECT_TRUE(says(refusal("damping = -0.01\n" + material), {"found.toml:1: damping", ">= 0"}));
}

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

class CalibratedCommand : public dlo::test::Command {
 protected:
  /// A scene's file.
  std::string wire(const std::string& name, const std::string& EI, const std::string& rod,
                   double direction) {
    std::ofstream(path(name)) << "[rod]\nlength = 1\nmass_per_length = 0.05\nbending_stiffness = "
                              << EI << "\n"
                              << rod << "[[gripper]]\nat = 0\nposition = [0, 0, 0]\n"
                              << "direction = \"" << direction << " deg\"\n";
    return path(name);
  }
};

/// Misaligned clamps and the position of one gripper are fitted to three shapes. With the file that
/// -o writes, the scene's rod has the measured shape.
TEST_F(CalibratedCommand, WhatCalibrateWritesMakesTheShapeRight) {
  std::string shapes;
  std::string scenes;
  for (const double direction : {-40.0, 10.0, 50.0}) {
    const std::string name = std::to_string(static_cast<int>(direction));
    const std::string truth =
        wire("truth" + name, "0.03", "natural_curvature = 0.7\n", direction + 8);
    succeeds("solve " + truth + " --samples 30 --format csv -o " + path(name + ".csv"));
    scenes += " " + wire("said" + name, "0.05", "", direction);
    shapes += " " + path(name + ".csv");
  }
  const auto found = run("calibrate" + scenes + " --shape" + shapes +
                         " --natural-curvature 1 --clamp-angles \"20 deg\" --same-clamps -o " +
                         path("found.toml"));
  ASSERT_EQ(found.status, 0) << found.err;
  const std::string check = "check " + path("said50") + " --shape " + path("50.csv") +
                            " --tolerance 0.0001 --no-explanation";
  EXPECT_EQ(run(check).status, 1);
  const auto calibrated = run(check + " --calibrated " + path("found.toml"));
  EXPECT_EQ(calibrated.status, 0) << calibrated.out << calibrated.err;
  // A hold-out shape is compared with the rod that was fitted to the others, and does not change
  // it.
  const std::string options = " --natural-curvature 1 --clamp-angles \"20 deg\" --same-clamps";
  const auto all = words_in(shapes);
  const auto held_out = run("calibrate" + scenes + " --shape " + all[0] + " " + all[1] +
                            " --holdout " + all[2] + options + " --format json");
  ASSERT_EQ(held_out.status, 0) << held_out.err;
  const auto document = nlohmann::json::parse(held_out.out);
  ASSERT_EQ(document.at("held_out").size(), 1U);
  EXPECT_EQ(document.at("held_out")[0].at("file"), all[2]);
  EXPECT_LT(document.at("held_out")[0].at("rms_m").get<double>(), 1e-5);
  const auto refused = run("calibrate" + scenes + " --shape " + all[0] + " --holdout " + all[2]);
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(says(refused.err, {"3 scenes, 1 shapes and 1 held out"}));
}

/// A wire so stiff that its shapes do not determine EI is nevertheless predicted by the other
/// fitted parameters.
TEST_F(CalibratedCommand, WhatIsNoMaterialIsWrittenIfItPredicts) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 1e-3);
  std::string words = "calibrate";
  std::string shapes = " --shape";
  for (const double direction : {-40.0, 10.0, 50.0}) {
    const std::string name = std::to_string(static_cast<int>(direction));
    words += " " + wire(name + ".toml", "20", "", direction);
    shapes += " " + path(name + ".csv");
    std::ofstream points(path(name + ".csv"));
    points << "x,y\n";
    const double angle = (direction + 8) * std::numbers::pi / 180;  // as if nothing bent it
    for (int i = 0; i <= 20; ++i) {
      points << 0.05 * i * std::cos(angle) + error(random) << ","
             << 0.05 * i * std::sin(angle) + error(random) << "\n";
    }
  }
  words += shapes + " --natural-curvature 1 --clamp-angles \"20 deg\" --same-clamps";
  expect_error(words + " --format toml", 2, {"no material to write", "not identifiable"});
  const auto found = run(words + " --predict -o " + path("found.toml"));
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_TRUE(says(found.out, {"EI          not identified"}));
  EXPECT_TRUE(says(read(path("found.toml")), {"No material: EI is not identifiable"}));
  const auto check = run("check " + path("10.toml") + " --shape " + path("10.csv") +
                         " --tolerance 0.002 --no-explanation --calibrated " + path("found.toml"));
  EXPECT_EQ(check.status, 0) << check.out << check.err;
}

}  // namespace
