// Tests of the command `dlo calibrate` with measured shapes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibrate_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

TEST_F(CalibrateCommand, FindsTheModulusOfMeasuredShapes) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string b = scene_of("b.toml", "5 GPa", 40);
  const std::string shapes =
      " --shape " + write_exact_shape(a, "a.csv") + " " + write_exact_shape(b, "b.csv");
  const std::string guess =
      scene_of("a.toml", "30 GPa", 0) + " " + scene_of("b.toml", "30 GPa", 40);
  for (const std::string pose : {"", " --register", " --register=upright"}) {
    const json document = json_of(words({"calibrate", guess, shapes, pose}));
    EXPECT_EQ(document.at("schema"), "dlo/calibrate/1");
    EXPECT_NEAR(document.at("youngs_modulus_Pa"), 5e9, 1e6);
    EXPECT_LT(document.at("interval_95_Pa")[0].get<double>(), 5e9);
    EXPECT_GT(document.at("interval_95_Pa")[1].get<double>(), 5e9);
    EXPECT_GT(document.at("uncertainty_Pa").get<double>(), 0);
    EXPECT_EQ(document.at("shapes").size(), 2U);
  }
}

// A curved wire that is assumed to be straight: the message names the parameter that removes the
// residuals.
TEST_F(CalibrateCommand, NamesWhatSystematicResidualsAskFor) {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  for (const int angle : {-15, 0, 15}) {
    const std::string straight = scene_of(fmt::format("s{}.toml", angle), "5 GPa", angle);
    const std::string bent =
        replaced(read(straight), "[rod]", "[rod]\nnatural_curvature = \"0.7 1/m\"");
    scenes.push_back(straight);
    shapes.push_back(write_exact_shape(scene(bent), fmt::format("s{}.csv", angle)));
  }
  const std::string command =
      fmt::format("calibrate {} --shape {}", fmt::join(scenes, " "), fmt::join(shapes, " "));
  const json document = json_of(command + " --options given");
  EXPECT_GT(document.at("common_share").get<double>(), 0.6);
  EXPECT_TRUE(has_all(document.at("alternatives").dump(), {"--natural-curvature 1"}));
  // With three shapes this parameter is chosen.
  const json chosen = json_of(command);
  EXPECT_EQ(chosen.at("tried")[0].at("options"), "--natural-curvature 1");
  EXPECT_NEAR(chosen.at("youngs_modulus_Pa"), 5e9, 5e6);
}

TEST_F(CalibrateCommand, EqualShapesCountOnce) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = write_table(
      "noisy.csv", "x,y,z", {{0.101, 0, 0}, {0.35, -0.02, 0}, {0.601, -0.04, 0}, {0.9, -0.11, 0}});
  const std::string one = words({"calibrate", a, "--shape", shape});
  const std::string copy = path("copy.csv");
  std::ofstream(copy) << read(shape);
  const std::string four = words({"calibrate", a, "--shape", shape, shape, copy, shape});
  const json once = json_of(one);
  const json repeated = json_of(four);
  EXPECT_EQ(repeated.at("interval_95_Pa"), once.at("interval_95_Pa"));
  EXPECT_EQ(repeated.at("shapes").size(), 1U);
  EXPECT_TRUE(has_all(run(four).out, {"shapes with the same points are fitted once", "copy.csv"}));
}

// Rods under their own weight, whose searches need more evaluations than one.
TEST_F(CalibrateCommand, FailedSolvesAreAnError) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = write_exact_shape(scene_of("a.toml", "5 MPa", 0), "a.csv");
  scene_of("a.toml", "5 GPa", 0);
  expect_error(words({"calibrate", a, "--shape", shape, "--max-evaluations 1"}), 3,
               {"a.toml", "equilibria ended at the evaluation limit", "--max-evaluations"});
}

TEST_F(CalibrateCommand, StatesWhatTheShapesCannotShow) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string command = words({"calibrate", a, "--shape", write_exact_shape(a, "a.csv")});
  const auto assumed = [&](const std::string& options) {
    return json_of(command + options).at("assumed");
  };
  EXPECT_TRUE(has_none(run(command).out, {"camera tilt"}));
  EXPECT_EQ(assumed(""), json({"length", "weight", "scale", "vertical", "natural curvature",
                               "clamp directions"}));
  EXPECT_EQ(assumed(" --register"),
            json({"length", "weight", "scale", "natural curvature", "clamp directions"}));
  EXPECT_EQ(assumed(" --clamp-angles \"5 deg\""),
            json({"length", "weight", "scale", "vertical", "natural curvature"}));
}

TEST_F(CalibrateCommand, SaysWhenTheShapesDoNotIdentifyE) {
  const std::string stiff = scene_of("a.toml", "5000 GPa", 0);
  const std::string shape = path("line.csv");
  std::ofstream(shape) << "0,0.001,0\n0.3,-0.001,0.001\n0.5,0.001,-0.001\n0.7,-0.0005,0\n0.9,0,0\n";
  const json document = json_of("calibrate " + stiff + " --shape " + shape);
  EXPECT_TRUE(document.at("youngs_modulus_Pa").is_null());
  EXPECT_TRUE(document.at("uncertainty_Pa").is_null());
  EXPECT_TRUE(document.at("interval_95_Pa")[1].is_null());
  EXPECT_TRUE(document.at("not_identified").is_string());
  expect_error("calibrate " + stiff + " --shape " + shape + " --format toml", 2,
               {"E is not identifiable"});
}

// A circle of radius 0.5 m: a weightless wire's natural curvature is 2 1/m.
TEST_F(CalibrateCommand, AWeightlessArcGetsItsCurvatureAndNoStiffness) {
  const std::string wire = scene(
      "gravity = [0, 0, 0]\n[rod]\nlength = 1\nbending_stiffness = 1e-3\nmass_per_length = 0.01\n" +
      level_clamp);
  std::vector<std::vector<double>> points;
  for (int i = 0; i <= 20; ++i) {
    const double s = i / 20.0;
    points.push_back({std::sin(2 * s) / 2, (1 - std::cos(2 * s)) / 2, 0, s});
  }
  const std::string command = "calibrate " + wire + " --shape " +
                              write_table("arc.csv", "x,y,z,s", points) + " --natural-curvature 1";
  const json document = json_of(command);
  EXPECT_TRUE(document.at("interval_95_Nm2")[0].is_null());
  EXPECT_TRUE(
      has_all(document.at("not_identified").get<std::string>(), {"EI is not identifiable"}));
  expect_error(command + " --format toml", 2, {"no material to write", "EI is not identifiable"});
}

TEST_F(CalibrateCommand, AColumnSInMetresBesideMillimetresIsRead) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::vector<std::vector<double>> solved = solved_points(a + " --model exact --samples 9");
  const auto scaled = [&](const std::string& name, double xyz, double along) {
    std::vector<std::vector<double>> points = solved;
    for (std::vector<double>& row : points) {
      for (std::size_t k = 0; k < 4; ++k) row[k] *= k < 3 ? xyz : along;
    }
    return write_table(name, "x,y,z,s", points);
  };
  const std::string guess = scene_of("a.toml", "9 GPa", 0);
  for (const double along : {1.0, 1e3}) {
    const std::string file = scaled("mm.csv", 1e3, along);
    const json fit =
        json_of(words({"calibrate", guess, "--shape", file, "--unit mm --arc-lengths file"}));
    EXPECT_NEAR(fit.at("youngs_modulus_Pa"), 5e9, 1e6) << along;
  }
  // s is neither in metres nor in millimetres: it is shorter than the polyline in either unit.
  expect_error(words({"calibrate", guess, "--shape", scaled("cm.csv", 1e3, 1e-2), "--unit mm"}), 2,
               {"cm.csv: s: spans", "--unit"});
}

TEST_F(CalibrateCommand, CsvIsATableAndTomlHasRemarks) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = write_exact_shape(a, "a.csv");
  for (const std::string& arguments :
       {words({"calibrate", a}), words({"calibrate", a, "--shape", shape})}) {
    EXPECT_TRUE(is_table(output_of(words({arguments, "--format csv"}))));
    EXPECT_TRUE(has_all(run(words({arguments, "--format toml"})).out, {"# "}));
  }
}

// Shapes of a light wire determine GJ / EI, but neither of the two.
TEST_F(CalibrateCommand, TellsHowStiffAWireIsAgainstTwist) {
  const std::string scene = shipped_scene("twisted_wire");
  const std::string shape = path("seen.csv");
  succeeds(words({"solve", scene, "--samples 20 --format csv -o", shape}));
  const std::string fit =
      words({"calibrate", scene, "--shape", shape, "--torsional-stiffness --noise \"0.2 mm\""});
  const json document = json_of(fit);
  EXPECT_TRUE(document.at("torsional_stiffness_Nm2").is_null());
  EXPECT_EQ(document.at("torsional_stiffness_interval_95_Nm2").size(), 2U);
  EXPECT_NEAR(document.at("torsional_over_bending_stiffness"), 0.00793 / 0.0103084, 1e-4);
  const std::string straight = scene_of("a.toml", "5 GPa", 0);
  expect_error(words({"calibrate", straight, "--torsional-stiffness --shape", shape}), 2,
               {"torsional stiffness", "two clamps"});
}

TEST_F(CalibrateCommand, BadInputIsOneLineAndStatusTwo) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = write_exact_shape(a, "a.csv");
  expect_error("calibrate " + a + " " + a + " --shape " + shape, 2, {"2 scenes", "1 shape"});
  expect_error("calibrate " + a + " --shape " + shape + " --noise 0", 2, {"--noise"});
  expect_error("calibrate " + a + " --density", 2, {"--density", "--shape"});
  expect_error("calibrate " + a + " --shape " + shape + " --target 1%", 2, {"--target"});
  for (const std::string target : {"0", "1", "0%", "100%", "x%", "nan%"}) {
    expect_error(words({"calibrate", a, "--target", target}), 2, {"--target"});
  }
  const std::string shapes = "calibrate " + a + " --shape " + shape;
  expect_error(shapes + " --clamp-angles \"5 mm\"", 2, {"--clamp-angles", "allowed: rad, deg"});
  expect_error(shapes + " --clamp-positions \"0 mm\"", 2, {"--clamp-positions", "allowed: > 0"});
  std::ofstream(path("bad.csv")) << "x,y\n1,2\n3\n";
  expect_error("calibrate " + a + " --shape " + path("bad.csv"), 2, {"bad.csv:3", "1 column"});
  std::ofstream(path("bad.toml")) << "[force_model]\nc_d = 1\n";
  expect_error("solve " + a + " --parameters " + path("bad.toml"), 2, {"bad.toml:2", "c_d"});
  std::ofstream(path("two.csv")) << "0,0\n0.3,0\n0.6,-0.1\n";
  expect_error("calibrate " + a + " --register --shape " + path("two.csv"), 2, {"more points"});
}

// No modulus makes a rod a thousand times as long.
TEST_F(CalibrateCommand, AShapeInAnotherUnitIsRefusedWithTheLikelyOne) {
  const std::string scene = scene_of("wire.toml", "5 MPa", 20);
  std::vector<std::vector<double>> points = solved_points(scene + " --model exact --samples 9");
  for (std::vector<double>& row : points) {
    for (double& number : row) number *= 1e3;
  }
  const std::string calibrate =
      "calibrate " + scene + " --shape " + write_table("mm.csv", "x,y,z", points);
  expect_error(calibrate, 2, {"mm.csv: polyline is", "times the rod: --unit mm?"});
  succeeds(calibrate + " --unit mm");
}

}  // namespace
}  // namespace dlo::compare
