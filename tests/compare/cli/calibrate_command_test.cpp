// The command calibrate as a user runs it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "command_fixture.hpp"

namespace {

using dlo::test::Command;
using dlo::test::Outcome;
using dlo::test::says;
using dlo::test::says_none;
using nlohmann::json;

class CalibrateCommand : public Command {
 protected:
  std::string scene_of(const std::string& name, const std::string& modulus, double angle,
                       const std::string& more = "") {
    std::ofstream(path(name)) << "[rod]\nlength = 1\ndiameter = \"4 mm\"\nmaterial = { "
                                 "youngs_modulus = \""
                              << modulus
                              << "\", density = 1200 }\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\n"
                                 "direction = \""
                              << angle << " deg\"\n"
                              << more;
    return path(name);
  }
  /// The exact shape of a scene, without arc lengths.
  std::string seen(const std::string& scene, const std::string& name) {
    EXPECT_EQ(
        run("solve " + scene + " --model exact --samples 9 --format csv -o " + path("all")).status,
        0);
    std::ifstream stream(path("all"));
    std::ofstream shape(path(name));
    for (std::string line; std::getline(stream, line);) {
      std::size_t end = 0;
      for (int column = 0; column < 3; ++column) end = line.find(',', end) + 1;
      shape << line.substr(0, end - 1) << "\n";
    }
    return path(name);
  }
};

TEST_F(CalibrateCommand, FindsTheModulusOfMeasuredShapes) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string b = scene_of("b.toml", "5 GPa", 40);
  const std::string shapes = " --shape " + seen(a, "a.csv") + " " + seen(b, "b.csv");
  const std::string guess =
      scene_of("a.toml", "30 GPa", 0) + " " + scene_of("b.toml", "30 GPa", 40);
  for (const std::string pose : {"", " --register", " --register=upright"}) {
    const json document = json_of(words({"calibrate", guess, shapes, pose}));
    EXPECT_EQ(document.at("schema"), "dlo/calibrate/1");
    EXPECT_NEAR(document.at("youngs_modulus_Pa").get<double>(), 5e9, 1e6);
    EXPECT_LT(document.at("interval_95_Pa")[0].get<double>(), 5e9);
    EXPECT_GT(document.at("interval_95_Pa")[1].get<double>(), 5e9);
    EXPECT_GT(document.at("uncertainty_Pa").get<double>(), 0);
    EXPECT_EQ(document.at("shapes").size(), 2U);
  }
}

// The clamp points 4 degrees off, and the wire was on a reel.
TEST_F(CalibrateCommand, FindsWhatElseAWireHas) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  std::string bent = read(a);
  bent.replace(bent.find("[rod]"), 5, "[rod]\nnatural_curvature = \"0.7 1/m\"");
  const std::string shape = seen(scene(bent), "a.csv");
  const std::string wire = words({"calibrate", a, "--shape", shape, "--natural-curvature 1",
                                  "--clamp-angles \"3 deg\" --clamp-positions \"1 mm\""});
  const json document = json_of(wire);
  const json& others = document.at("others");
  ASSERT_EQ(others.size(), 4U);
  EXPECT_EQ(others[0].at("unit"), "1/m");
  EXPECT_NEAR(others[0].at("value").get<double>(), 0.7, 1e-3);
  EXPECT_TRUE(others[0].at("seen").get<bool>());
  EXPECT_TRUE(others[0].at("shape").is_null());
  EXPECT_EQ(others[1].at("unit"), "rad");
  EXPECT_EQ(others[1].at("shape"), 0);
  EXPECT_TRUE(says(run(wire).out, {"natural curvature, P_0: 0.7"}));
  EXPECT_EQ(run(wire + " -o " + path("wire.toml")).status, 0);
  EXPECT_TRUE(says(read(path("wire.toml")), {"natural_curvature = [[0.000000e+00, 7.0"}));
  expect_error(words({"calibrate", a, "--shape", shape, "--clamp-angles \"5 mm\""}), 2,
               {"--clamp-angles", "5 mm", "allowed: rad, deg"});
  expect_error(words({"calibrate", a, "--shape", shape, "--clamp-positions \"0 mm\""}), 2,
               {"--clamp-positions", "allowed: > 0"});
}

// The same wire taken for straight: what would remove its residuals is told.
TEST_F(CalibrateCommand, NamesWhatSystematicResidualsAskFor) {
  std::vector<std::string> scenes;
  std::vector<std::string> shapes;
  for (const int angle : {-15, 0, 15}) {
    const std::string straight = scene_of(fmt::format("s{}.toml", angle), "5 GPa", angle);
    std::string bent = read(straight);
    bent.replace(bent.find("[rod]"), 5, "[rod]\nnatural_curvature = \"0.7 1/m\"");
    scenes.push_back(straight);
    shapes.push_back(seen(scene(bent), fmt::format("s{}.csv", angle)));
  }
  const std::string command =
      fmt::format("calibrate {} --shape {}", fmt::join(scenes, " "), fmt::join(shapes, " "));
  const std::string given = command + " --options given";
  const std::string text = run(given).out;
  EXPECT_TRUE(says(text, {"the residuals are systematic",
                          "(RMS)\n            --natural-curvature 1 would leave ",
                          "the density: nothing but gravity"}));
  const json document = json_of(given);
  EXPECT_GT(document.at("common_share").get<double>(), 0.6);
  const json& all = document.at("alternatives");
  const auto named = std::find_if(all.begin(), all.end(), [](const json& one) {
    return one.at("options") == "--natural-curvature 1";
  });
  ASSERT_NE(named, all.end());
  EXPECT_NEAR(named->at("youngs_modulus_Pa").get<double>(), 5e9, 5e6);
  EXPECT_LT(named->at("rms_m").get<double>(), 1e-5);
  // Of three shapes it is chosen.
  const json chosen = json_of(command);
  EXPECT_EQ(chosen.at("tried")[0].at("options"), "--natural-curvature 1");
  EXPECT_NEAR(chosen.at("youngs_modulus_Pa").get<double>(), 5e9, 5e6);
}

TEST_F(CalibrateCommand, TellsTheJointsOfAChain) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string chain = words({"calibrate", a, "--shape", seen(a, "a.csv"), "--segments 12"});
  const json chains = json_of(chain).at("chains");
  ASSERT_EQ(chains.size(), 3U);
  EXPECT_EQ(chains[0].at("clamp"), "hinge");
  EXPECT_EQ(chains[2].at("clamp"), "middle");
  EXPECT_NEAR(chains[2].at("over_bending_stiffness_per_length").get<double>(), 1, 0.02);
  EXPECT_EQ(chains[1].at("parameters")[2].at("name"), "add_rod bend_stiffness before 1.2.0");
  EXPECT_EQ(chains[1].at("parameters")[3].at("name"), "add_rod bend_stiffness 1.2.0 to 1.4");
  const std::string text = run(chain).out;
  EXPECT_TRUE(says(
      text, {"12 segments of 0.08333 m, a hinge at the clamp", "PyElastica youngs_modulus = "}));
  expect_error(words({"calibrate", a, "--shape", path("a.csv"), "--segments 3"}), 2,
               {"--segments", "3"});
  // Of the scene's own rod, which is that of the shape.
  const std::string own = words({"calibrate", a, "--segments 12"});
  const json bare = json_of(own).at("chains");
  ASSERT_EQ(bare.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const char* const joint = "joint_stiffness_Nm_per_rad";
    EXPECT_NEAR(bare[i].at(joint).get<double>() / chains[i].at(joint).get<double>(), 1, 1e-3);
  }
  EXPECT_TRUE(says(run(own).out, {"Isaac Sim  PhysicsDriveAPI:rotX stiffness = "}));
  expect_error(own + " --format csv", 2, {"--segments", "csv"});
  // Of unequal segments, as a file has them, each joint has its own.
  std::ofstream(path("joints.csv")) << "0,0,0\n0.2,0,0\n0.5,0,0\n0.6,0,0\n0.8,0,0\n1,0,0\n";
  for (const std::string& unequal :
       {words({"calibrate", a, "--segments", path("joints.csv")}),
        words({"calibrate", a, "--shape", path("a.csv"), "--segments", path("joints.csv")})}) {
    const json of = json_of(unequal).at("chains");
    ASSERT_EQ(of.size(), 2U);
    EXPECT_EQ(of[1].at("clamp"), "welded");
    const json joints = of[1].at("joints");
    ASSERT_EQ(joints.size(), 4U);
    EXPECT_NEAR(joints[1].at("at_m").get<double>(), 0.5, 0.02);
    const char* const joint = "joint_stiffness_Nm_per_rad";
    // Between 0.3 and 0.1 m as between 0.2 and 0.2 m, but for 0.2 and 0.3 m.
    EXPECT_NEAR(joints[1].at(joint).get<double>() / joints[3].at(joint).get<double>(), 1, 1e-3);
    EXPECT_NEAR(joints[1].at(joint).get<double>() / joints[0].at(joint).get<double>(), 1.25, 1e-3);
    EXPECT_TRUE(of[1].at("parameters").empty());
    const std::string told = run(unequal).out;
    EXPECT_TRUE(says(told, {"5 segments of 0.1 to 0.3 m, a hinge at the clamp",
                            "times EI/h, h the mean of its two segments"}));
  }
  expect_error(words({"calibrate", a, "--segments", path("none.csv")}), 2, {"none.csv"});
}

TEST_F(CalibrateCommand, WritesAMaterialThatScenesCanUse) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = seen(a, "a.csv");
  const std::string guess = scene_of("a.toml", "9 GPa", 0);
  const Outcome result =
      run("calibrate " + guess + " --shape " + shape + " -o " + path("material.toml"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(says(result.out, {"95 %"}));
  std::string text = read(a);
  text.replace(text.find("{ youngs"), text.find('}') + 1 - text.find("{ youngs"), "\"calibrated\"");
  const std::string calibrated = scene(text);
  EXPECT_EQ(run("check " + calibrated + " --materials " + path("material.toml") + " --shape " +
                shape + " --arc-lengths nearest --tolerance 0.1%")
                .status,
            0);
}

TEST_F(CalibrateCommand, SaysWhenTheShapesDoNotIdentifyE) {
  const std::string stiff = scene_of("a.toml", "5000 GPa", 0);
  const std::string shape = path("line.csv");
  std::ofstream(shape) << "0,0.001,0\n0.3,-0.001,0.001\n0.5,0.001,-0.001\n0.7,-0.0005,0\n0.9,0,0\n";
  const Outcome text = run("calibrate " + stiff + " --shape " + shape);
  EXPECT_EQ(text.status, 0);
  EXPECT_TRUE(says(text.out, {"E is not identifiable from these shapes: E > "}));
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
  const std::string scene = path("arc.toml");
  std::ofstream(scene)
      << "gravity = [0, 0, 0]\n[rod]\nlength = 1\nbending_stiffness = \"1e-3 N "
         "m^2\"\nmass_per_length = \"10 g/m\"\n[[gripper]]\nat = 0\nposition = [0, "
         "0, 0]\ndirection = \"0 deg\"\n";
  const std::string shape = path("arc.csv");
  std::ofstream points(shape);
  points << "x,y,z,s\n";
  for (int i = 0; i <= 20; ++i) {
    const double s = i / 20.0;
    points << fmt::format("{:.17g},{:.17g},0,{:.17g}\n", std::sin(2 * s) / 2,
                          (1 - std::cos(2 * s)) / 2, s);
  }
  points.close();
  const std::string command = "calibrate " + scene + " --shape " + shape + " --natural-curvature 1";
  const Outcome text = run(command);
  EXPECT_EQ(text.status, 0);
  EXPECT_EQ(text.out.find("EI          not identified   (scene"), 0) << text.out;
  EXPECT_TRUE(says(text.out, {"natural curvature, P_0: 2 1/m"}));
  const json document = json_of(command);
  EXPECT_TRUE(document.at("interval_95_Nm2")[0].is_null());
  EXPECT_TRUE(says(document.at("not_identified").get<std::string>(), {"EI is not identifiable"}));
  expect_error(command + " --format toml", 2, {"no material to write", "EI is not identifiable"});
}

TEST_F(CalibrateCommand, SaysThatErrorsAreCorrelatedInEveryFormat) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const Outcome solved =
      run("solve " + a + " --model exact --samples 41 --format csv -o " + path("all"));
  ASSERT_EQ(solved.status, 0) << solved.err;
  // A slow wave of 1 mm across the rod, as of a lens, and next to it noise that has no memory.
  const auto shape = [&](const std::string& name, auto&& error) {
    std::ifstream stream(path("all"));
    std::ofstream out(path(name));
    std::string line;
    std::getline(stream, line);
    out << "x,y,z\n";
    for (int i = 0; std::getline(stream, line); ++i) {
      std::array<double, 3> p{};
      EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", p.data(), &p[1], &p[2]), 3);
      out << p[0] + error(i) << "," << p[1] + error(i + 13) << "," << p[2] + error(i + 29) << "\n";
    }
    return path(name);
  };
  const std::string wave = shape("wave.csv", [](int i) { return 1e-3 * std::sin(i / 4.0); });
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1e-3);
  const std::string noise = shape("noise.csv", [&](int) { return normal(random); });
  const auto text = [&](const std::string& file, const std::string& format) {
    const Outcome result = run(words({"calibrate", a, "--shape", file, "--format", format}));
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  EXPECT_TRUE(says(text(wave, "text"), {"errors along the rod are correlated"}));
  EXPECT_TRUE(says_none(text(noise, "text"), {"correlated"}));
  const json said = json::parse(text(wave, "json"));
  EXPECT_TRUE(said.at("errors_are_correlated").get<bool>());
  EXPECT_GT(said.at("correlation").at("interval_widened_by").get<double>(), 1.5);
  EXPECT_GT(said.at("correlation").at("length_m").get<double>(), 0.025);
  const json not_said = json::parse(text(noise, "json"));
  EXPECT_FALSE(not_said.at("errors_are_correlated").get<bool>());
  EXPECT_TRUE(not_said.at("correlation").is_null());
  EXPECT_TRUE(says(text(wave, "csv"), {",true,"}));
  EXPECT_TRUE(says(text(noise, "csv"), {",false,,,,,,,,\n"}));
}

TEST_F(CalibrateCommand, AColumnSInMetresBesideMillimetresIsRead) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  ASSERT_EQ(run("solve " + a + " --model exact --samples 9 --format csv -o " + path("all")).status,
            0);
  const auto scaled = [&](const std::string& name, double xyz, double along) {
    std::ifstream stream(path("all"));
    std::ofstream out(path(name));
    std::string line;
    std::getline(stream, line);
    out << "x,y,z,s\n";
    while (std::getline(stream, line)) {
      std::array<double, 4> p{};
      EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", p.data(), &p[1], &p[2], &p[3]), 4);
      out << p[0] * xyz << "," << p[1] * xyz << "," << p[2] * xyz << "," << p[3] * along << "\n";
    }
    return path(name);
  };
  const std::string guess = scene_of("a.toml", "9 GPa", 0);
  for (const double along : {1.0, 1e3}) {
    const std::string file = scaled("mm.csv", 1e3, along);
    const Outcome result = run(
        words({"calibrate", guess, "--shape", file, "--unit mm --arc-lengths file --format json"}));
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NEAR(json::parse(result.out).at("youngs_modulus_Pa").get<double>(), 5e9, 1e6) << along;
  }
  // Neither millimetres nor metres: s must be at least as long as the polyline.
  expect_error(words({"calibrate", guess, "--shape", scaled("cm.csv", 1e3, 1e-2), "--unit mm"}), 2,
               {"cm.csv: s: spans", "--unit"});
}

TEST_F(CalibrateCommand, WritesParametersThatTheOtherCommandsRead) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string b = scene_of("b.toml", "5 GPa", -30);
  for (const std::string law : {"hooke", "paper"}) {
    const std::string file = path(law + ".toml");
    const std::string calibrate = words({"calibrate", a, "--holdout", b, "--law", law});
    const Outcome result = run(words({calibrate, "-o", file}));
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(says(result.out, {"hold-out"}));
    const json fit = json_of(calibrate);
    const json compared = json_of(words({"compare", b, "--parameters", file})).at("cases")[0];
    EXPECT_EQ(compared.at("law"), law);
    EXPECT_EQ(compared.at("points"), fit.at("parameters").at("points"));
    EXPECT_NEAR(compared.at("deviation").at("rms_over_length").get<double>(),
                fit.at("deviation").at("worst_holdout_rms_over_length").get<double>(), 1e-7);
    // What is printed of every scene is what its printed parameters give.
    const json fitted = json_of(words({"compare", a, "--parameters", file})).at("cases")[0];
    EXPECT_NEAR(fitted.at("deviation").at("rms_over_length").get<double>(),
                fit.at("scenes")[0].at("rms_over_length").get<double>(), 1e-7);
    const double worst = std::max(fitted.at("deviation").at("rms_over_length").get<double>(),
                                  compared.at("deviation").at("rms_over_length").get<double>());
    EXPECT_EQ(fit.at("reached").get<bool>(), worst <= fit.at("target").get<double>());
    EXPECT_NEAR(compared.at("parameters").at("c_F").get<double>() /
                    fit.at("parameters").at("c_F").get<double>(),
                1, 1e-8);
    // What the command line says goes before the file.
    EXPECT_EQ(json_of(words({"solve", a, "--model chain --parameters", file, "--points 9"}))
                  .at("points_m")
                  .size(),
              9U);
  }
}

TEST_F(CalibrateCommand, AMissedTargetIsStatusOne) {
  const std::string a = scene_of("a.toml", "2 GPa", 0);
  EXPECT_EQ(run("calibrate " + a + " --target 0.1%").status, 0);
  EXPECT_EQ(run("calibrate " + a + " --target 0.001% --points 16").status, 1);
  EXPECT_EQ(run("calibrate " + a + " --law paper --target 0.1%").status, 1);
  EXPECT_EQ(run("calibrate " + a + " --law paper").status, 0);
}

TEST_F(CalibrateCommand, TellsWhatMadeTheTargetMissed) {
  const std::string stiff = scene_of("a.toml", "5 GPa", 0);
  const auto missed = [&](const std::string& arguments) {
    const Outcome result = run("calibrate " + arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    return result.out;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  // Segments alone are off: stretch is not what is wrong.
  const std::string coarse = missed(stiff + " --target 0.01% --points 8");
  EXPECT_TRUE(has(coarse, "N = 8 is too few")) << coarse;
  EXPECT_TRUE(has(coarse, "without\n  --points") || has(coarse, "without --points")) << coarse;
  EXPECT_FALSE(has(coarse, "A E: the rod")) << coarse;
  // A rod of 500 kPa stretches under its weight by more than the target.
  const std::string soft = scene_of("soft.toml", "500 kPa", -90);
  const json fit = json::parse(missed(soft + " --target 0.01% --points 24 --format json"));
  EXPECT_FALSE(fit.at("reached").get<bool>());
  const double stretch = fit.at("scenes")[0].at("stretch_rms_over_length").get<double>();
  // Hanging straight, l = 1 m: u(s) = rho g (s - s^2 / 2) / E, from the half of a segment on that
  // the gripper holds.
  const double held = fit.at("parameters").at("segment_length_m").get<double>() / 2;
  const double scale = 1200 * 9.81 / 500e3;
  const auto u = [&](double s) { return scale * (s - s * s / 2); };
  const double mean_square = scale * scale * 2 / 15 - 2 * u(held) * scale / 3 + u(held) * u(held);
  EXPECT_NEAR(stretch, std::sqrt(mean_square), 0.005 * stretch);
  ASSERT_EQ(fit.at("why_missed").size(), 1U);
  EXPECT_TRUE(has(fit.at("why_missed")[0], "c_c is A E")) << fit;
  EXPECT_TRUE(has(missed(stiff + " --law paper --target 0.001%"), "law paper"));
  // The parameter file says where c_c is from and whether it is good enough.
  const std::string toml =
      run("calibrate " + soft + " --target 0.01% --points 24 --format toml").out;
  EXPECT_TRUE(has(toml, "# Target 0.01 %: not reached.")) << toml;
  EXPECT_TRUE(has(toml, "stretch stiffness: A E of the rod\n")) << toml;
  EXPECT_TRUE(has(run("calibrate " + stiff + " --c-c 200 --format toml").out,
                  "stretch stiffness: as given\n"));
  EXPECT_TRUE(has(run("calibrate " + stiff + " --format toml").out, "tenth of the target at most"));
}

TEST_F(CalibrateCommand, EveryFormatIsWritten) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = seen(a, "a.csv");
  for (const std::string& arguments :
       {words({"calibrate", a}), words({"calibrate", a, "--shape", shape})}) {
    EXPECT_TRUE(says(run(arguments).out, {"RMS"}));
    const Outcome csv = run(words({arguments, "--format csv"}));
    EXPECT_EQ(csv.status, 0) << csv.err;
    const std::string header = csv.out.substr(0, csv.out.find('\n'));
    const std::string row = csv.out.substr(csv.out.find('\n') + 1);
    EXPECT_EQ(std::count(header.begin(), header.end(), ','),
              std::count(row.begin(), row.end(), ','));
    EXPECT_TRUE(says(run(words({arguments, "--format toml"})).out, {"# "}));
  }
}

// Shapes of a light wire tell GJ / EI, but neither of the two.
TEST_F(CalibrateCommand, TellsHowStiffAWireIsAgainstTwist) {
  const std::string scene = std::string(DLO_DATA) + "/scenes/twisted_wire.toml";
  const std::string shape = path("seen.csv");
  ASSERT_EQ(run(words({"solve", scene, "--samples 20 --format csv -o", shape})).status, 0);
  const std::string fit =
      words({"calibrate", scene, "--shape", shape, "--torsional-stiffness --noise \"0.2 mm\""});
  const json document = json_of(fit);
  EXPECT_TRUE(document.at("torsional_stiffness_Nm2").is_null());
  EXPECT_EQ(document.at("torsional_stiffness_interval_95_Nm2").size(), 2U);
  EXPECT_NEAR(document.at("torsional_over_bending_stiffness").get<double>(), 0.00793 / 0.0103084,
              1e-4);
  const std::string text = run(fit).out;
  EXPECT_TRUE(says(text, {"GJ          not identified, 95 %: ", "GJ / EI     0.76928, 95 %: "}));
  const std::string straight = scene_of("a.toml", "5 GPa", 0);
  expect_error(words({"calibrate", straight, "--torsional-stiffness --shape", shape}), 2,
               {"torsional stiffness", "two clamps"});
}

TEST_F(CalibrateCommand, BadInputIsOneLineAndStatusTwo) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string shape = seen(a, "a.csv");
  expect_error("calibrate", 2, {"SCENE"});
  expect_error("calibrate " + a + " " + a + " --shape " + shape, 2, {"2 scenes", "1 shape"});
  expect_error("calibrate " + a + " --shape " + shape + " --noise 0", 2, {"--noise"});
  expect_error("calibrate " + a + " --shape " + shape + " --noise \"-1 mm\"", 2, {"--noise"});
  expect_error("calibrate " + a + " --density", 2, {"--density", "--shape"});
  expect_error("calibrate " + a + " --shape " + shape + " --target 1%", 2, {"--target"});
  for (const std::string target : {"0", "1", "0%", "100%", "x%", "nan%"}) {
    expect_error(words({"calibrate", a, "--target", target}), 2, {"--target"});
  }
  std::ofstream(path("bad.csv")) << "x,y\n1,2\n3\n";
  expect_error("calibrate " + a + " --shape " + path("bad.csv"), 2, {"bad.csv:3", "1 column"});
  std::ofstream(path("bad.toml")) << "[force_model]\nc_d = 1\n";
  expect_error("solve " + a + " --parameters " + path("bad.toml"), 2, {"bad.toml:2", "c_d"});
  expect_error("solve " + a + " --parameters " + path("none.toml"), 2, {"none.toml", "read"});
  std::ofstream(path("two.csv")) << "0,0\n0.3,0\n0.6,-0.1\n";
  expect_error("calibrate " + a + " --register --shape " + path("two.csv"), 2, {"more points"});
}

TEST_F(CalibrateCommand, HelpHasExamples) {
  const Outcome help = run("calibrate --help");
  EXPECT_EQ(help.status, 0);
  EXPECT_TRUE(says(help.out, {"dlo calibrate data/scenes"}));
}

TEST_F(CalibrateCommand, KeepsAStepperThatHasNoParameters) {
  const std::string scene = scene_of("wire.toml", "5 MPa", 20);
  const std::string file = path("parameters.toml");
  for (const std::string stepper : {"implicit", "verlet"}) {
    const Outcome result =
        run("calibrate " + scene + " --points 12 --stepper " + stepper + " -o " + file);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(says(result.out, {"stepper " + stepper + ", which has no parameters"}));
    const std::string text = read(file);
    EXPECT_TRUE(says(text, {"stepper = \"" + stepper + "\"\n"}));
    EXPECT_TRUE(says_none(text, {"c_F"}));
    EXPECT_EQ(run("solve " + scene + " --model force --parameters " + file).status, 0);
  }
  const json document = json_of("calibrate " + scene + " --points 12 --stepper implicit");
  EXPECT_EQ(document.at("parameters").at("stepper"), "implicit");
  EXPECT_TRUE(document.at("parameters").at("c_F").is_null());
}

// No modulus makes a rod a thousand times as long.
TEST_F(CalibrateCommand, AShapeInAnotherUnitIsRefusedWithTheLikelyOne) {
  const std::string scene = scene_of("wire.toml", "5 MPa", 20);
  const std::string metres = seen(scene, "metres.csv");
  std::ifstream stream(metres);
  std::string line;
  std::getline(stream, line);
  std::ofstream millimetres(path("mm.csv"));
  millimetres << line << "\n";
  while (std::getline(stream, line)) {
    double x = 0;
    double y = 0;
    double z = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &x, &y, &z), 3) << line;
    millimetres << fmt::format("{},{},{}\n", 1e3 * x, 1e3 * y, 1e3 * z);
  }
  millimetres.close();
  const std::string calibrate = "calibrate " + scene + " --shape " + path("mm.csv");
  expect_error(calibrate, 2, {"mm.csv: polyline is", "times the rod: --unit mm?"});
  EXPECT_EQ(run(calibrate + " --unit mm").status, 0);
}

}  // namespace
