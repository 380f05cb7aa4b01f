// Tests of couples and distributed loads of a scene: accepted keys of its file, and the results of
// each model.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "../scenes.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string clamped_at_its_begin =
    "[rod]\nlength = \"2 m\"\nbending_stiffness = \"0.5 N m^2\"\nmass_per_length = \"20 g/m\"\n" +
    test::level_clamp;

void expect_load_refused(const std::string& loads, const std::vector<std::string>& parts) {
  EXPECT_TRUE(has_all(test::scene_error(clamped_at_its_begin + loads), parts));
}

double largest_difference(const Solution& a, const Solution& b) {
  return (a.shape.points - b.shape.points).cwiseAbs().maxCoeff();
}

TEST(Loads, OfAFileHaveUnitsAndPlaces) {
  const Scene scene = parse_scene(clamped_at_its_begin + R"([[load]]
at = "50 cm"
torque = [0, 0, "200 mN m"]
[[load]]
at = "2 m"
force = [0, "1 N", 0]
torque = [0, 0, "-200 N mm"]
[[distributed_load]]
force_per_length = [0, "0.3 N/m", 0]
[[distributed_load]]
from = "40 cm"
to = "1 m"
force_per_length = [[0, 1, 0], [0, 3, 0], ["1 mN/m", 0, 0]]
)",
                                  "my.toml");
  EXPECT_EQ(scene.loads[0].force, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(scene.loads[0].torque, Eigen::Vector3d(0, 0, 0.2));
  EXPECT_EQ(scene.loads[1].torque, Eigen::Vector3d(0, 0, -0.2));
  ASSERT_EQ(scene.distributed_loads.size(), 2U);
  EXPECT_EQ(scene.distributed_loads[0].from, 0);
  EXPECT_EQ(scene.distributed_loads[0].to, 2);
  // The means of its halves are 2 and 1.5 N/m.
  EXPECT_NEAR(scene.distributed_loads[1].force_between(0, 2).y(), 0.3 * 2 + 0.3 * 1.5, 1e-14);
  EXPECT_NEAR(scene.distributed_between(0, 0.55).y(), 0.3 * 0.55 + 0.15 * 1.5, 1e-14);
}

TEST(Loads, RefusalsNameTheKeyThePlaceAndWhatIsAllowed) {
  expect_load_refused("[[load]]\nat = 0.5\n", {"my.toml:9", "load.force", "missing"});
  expect_load_refused("[[load]]\nat = 0.5\ntorque = [0, 0, \"1 N\"]\n",
                      {"my.toml:11", "load.torque", "N m"});
  expect_load_refused("[[load]]\nat = 0.5\nmass = 1\nfollows = true\n",
                      {"my.toml:12", "load.follows", "mass"});
  expect_load_refused("[[load]]\nat = 0\nforce = [0, 1, 0]\nfollows = true\n",
                      {"my.toml:12", "load.follows", "position of a clamp"});
  expect_load_refused("[[load]]\nat = 1\nforce = [0, 1, 0]\nfollows = 1\n",
                      {"my.toml:12", "load.follows", "true or false"});
  expect_load_refused(
      "[[load]]\nat = 0.5\ntorque = [0, 0, 1]\n[[obstacle]]\npoint = [0, -1, 0]\n"
      "normal = [0, 1, 0]\n",
      {"load.torque", "obstacles"});
  expect_load_refused("[[distributed_load]]\nfrom = 1\nto = 0.5\nforce_per_length = [0, 1, 0]\n",
                      {"my.toml:11", "distributed_load.to", "to > from"});
  expect_load_refused("[[distributed_load]]\nforce = [0, 1, 0]\n",
                      {"my.toml:10", "unknown key", "force_per_length"});
  expect_load_refused("[[distributed_load]]\nforce_per_length = [[0, 1, 0]]\n",
                      {"distributed_load.force_per_length", "2 to"});
  expect_load_refused("[[distributed_load]]\nforce_per_length = [0, \"1 N\", 0]\n",
                      {"force_per_length", "N/m"});
}

TEST(Loads, DistributedInsteadOfTheWeightBendAlikeInEveryModel) {
  Scene heavy = heavy_scene(5, 20);
  Scene loaded = heavy;
  loaded.distributed_loads = {{0, 1, {heavy.weight_per_length()}}};
  loaded.gravity.setZero();
  for (const Model model : {Model::energy, Model::exact, Model::chain, Model::force}) {
    SCOPED_TRACE(to_string(model));
    const Solution one = solve(heavy, model);
    const Solution other = solve(loaded, model);
    EXPECT_LT(largest_difference(one, other), model == Model::force ? 1e-7 : 1e-12);
    EXPECT_NEAR(other.energy.gravity, 0, 1e-12);
    // The steps of the force model end at a small distance from rest.
    const double rest = model == Model::force ? 1e-6 : 1e-9;
    EXPECT_NEAR(other.energy.load, one.energy.gravity, rest * std::abs(one.energy.gravity));
    EXPECT_LT((other.grippers[0].force - one.grippers[0].force).norm(),
              1e-6 * one.grippers[0].force.norm());
  }
}

TEST(Loads, ChainsOfAPartlyLoadedRodConvergeAtSecondOrder) {
  Scene scene = heavy_scene(1, 0);
  const double w = scene.weight_per_length().norm();
  scene.distributed_loads = {{0.25, 0.75, {{0, -8 * w, 0}, {3 * w, 5 * w, 0}}},
                             {0.5, 1, {{0, 6 * w, 0}}}};
  std::vector<double> errors;
  for (const int points : {24, 96, 384}) {
    scene.force_model.points = points;
    const Solution chain = solve(scene, Model::chain);
    const Solution energy = solve(scene, Model::energy, {}, chain.shape.arc_length);
    errors.push_back(largest_difference(chain, energy));
  }
  EXPECT_NEAR(std::log(errors[0] / errors[2]) / std::log(16), 2, 0.2);
  EXPECT_LT(errors[2], 1e-5);
}

TEST(Loads, TensionCountsWhatIsDistributed) {
  Scene hanging = heavy_scene(1, -90);
  const double w = hanging.weight_per_length().norm();
  hanging.distributed_loads = {{0, 0.5, {{0, -2 * w, 0}}}};
  const Solution solution = solve(hanging, Model::energy, {}, {0, 0.25, 0.75});
  EXPECT_NEAR(solution.tension[0], 2 * w, 1e-9 * w);
  EXPECT_NEAR(solution.tension[1], 0.75 * w + 0.5 * w, 1e-9 * w);
  EXPECT_NEAR(solution.tension[2], 0.25 * w, 1e-9 * w);
}

TEST(Loads, AMediumBearsWhatTheRodDisplaces) {
  const auto scene_of = [](const std::string& section, double density, const std::string& medium) {
    return parse_scene("[rod]\nlength = 1\n" + section +
                           "material = { youngs_modulus = 1e8, density = " +
                           std::to_string(density) + " }\n" + test::level_clamp + medium,
                       "my.toml");
  };
  const std::string water = "[medium]\ndensity = \"1000 kg/m^3\"\n";
  const std::string oil = "[medium]\ndensity = 800\n";
  const std::string flat = "width = 0.012\nthickness = 0.003\n";
  const std::string round = "diameter = 0.01\n";
  const auto moved = [&](const std::string& section, double density, const std::string& medium,
                         double remaining) {
    return largest_difference(solve(scene_of(section, density, medium), Model::energy),
                              solve(scene_of(section, remaining, ""), Model::energy));
  };
  EXPECT_LT(moved(round, 1400, water, 400), 1e-11);
  EXPECT_LT(moved(flat, 1300, oil, 500), 1e-9);
  const Solution floats = solve(scene_of(round, 1000, water), Model::exact);
  EXPECT_LT(floats.shape.points.row(1).cwiseAbs().maxCoeff(), 1e-12);
  expect_load_refused("[medium]\ndensity = 1000\n", {"medium.density", "diameter"});
  const std::string stream = "velocity = [1, 0, 0]\nnormal_drag = 1.2\n";
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return scene_of(flat, 1300, water + stream); }),
                      {"medium.velocity", "flat", "diameter"}));
}

const std::string thick_rod_held =
    "[rod]\nlength = 1\ndiameter = 0.01\nmaterial = { youngs_modulus = 2e8, density = 1100 }\n" +
    test::level_clamp;

TEST(Loads, AStreamDragsByMorisonsLawOnTheDiameter) {
  const Scene scene = parse_scene(thick_rod_held + R"([medium]
density = 1000
velocity = ["3.6 km/h", 0, 0]
normal_drag = 1.2
tangential_drag = 0.02
)",
                                  "my.toml");
  ASSERT_TRUE(scene.drag.has_value());
  EXPECT_NEAR(scene.drag->velocity.x(), 1, 1e-15);
  // The drag is 1/2 rho C_n d v^2 across the rod, and 1/2 rho C_t pi d v^2 along it.
  EXPECT_NEAR(scene.drag->force({0, 1, 0}).x(), 0.5 * 1000 * 1.2 * 0.01, 1e-12);
  EXPECT_NEAR(scene.drag->force({1, 0, 0}).x(), 0.5 * 1000 * 0.02 * std::numbers::pi * 0.01, 1e-12);
  EXPECT_EQ(scene.distributed_loads.size(), 1U);  // the buoyancy of the medium
  const auto refused = [](const std::string& medium, const std::vector<std::string>& parts) {
    EXPECT_TRUE(
        has_all(test::scene_error(thick_rod_held + "[medium]\ndensity = 1000\n" + medium), parts));
  };
  refused("velocity = [1, 0, 0]\n", {"medium.normal_drag", "missing"});
  refused("normal_drag = 1\n", {"my.toml:9", "medium.velocity", "beside normal_drag"});
  refused("velocity = [1, 0, 0]\nnormal_drag = -1\n", {"medium.normal_drag", ">= 0"});
  refused("velocity = [\"1 m\", 0, 0]\nnormal_drag = 1\n", {"medium.velocity", "m/s"});
  refused(
      "velocity = [1, 0, 0]\nnormal_drag = 1\n[[obstacle]]\npoint = [0, -1, 0]\n"
      "normal = [0, 1, 0]\n",
      {"medium.velocity", "obstacles"});
}

TEST(Loads, WhatHasNoPotentialIsForExactWhichSaysWhatItHasChecked) {
  const std::string turning = "[[load]]\nat = 0.5\nforce = [1, 0, -2]\nfollows = true\n";
  const std::string in_space = "[[load]]\nat = 1\ntorque = [0.2, 0.3, 0.1]\n";
  const std::string stream =
      "[medium]\ndensity = 1000\nvelocity = [1, 0, 0.5]\nnormal_drag = 1.2\n";
  const std::vector<std::array<std::string, 3>> cases = {
      {turning, "load.follows", "follower load"},
      {in_space + "[[load]]\nat = 0.4\nforce = [1, 0, 0]\n", "load.torque", "couple in space"},
      {stream, "medium.velocity", "drag"}};
  for (const auto& [text, key, why] : cases) {
    const Scene scene = parse_scene(thick_rod_held + text, "my.toml");
    for (const Model model : {Model::energy, Model::chain, Model::force}) {
      if (model == Model::force && scene.drag) continue;
      EXPECT_TRUE(has_all(error_of<InputError>([&] { return solve(scene, model); }),
                          {key, "--model exact"}));
    }
    const Solution exact = solve(scene, Model::exact);
    EXPECT_TRUE(has_all(exact.message, {"stability is not judged", why}));
    EXPECT_TRUE(std::isnan(exact.smallest_eigenvalue));
    // The tension is zero at a free tip. At the clamp, whose direction is +x, it is minus the x
    // component of the gripper's force.
    EXPECT_NEAR(exact.tension.back(), 0, 1e-8);
    EXPECT_NEAR(exact.tension.front(), -exact.grippers[0].force.x(), 1e-6);
  }
}

TEST(Loads, PolygonsNameTheOneThatTheyDoNotTake) {
  for (const std::string load : {"torque = [0, 0, 0.1]\n", "force = [0, 1, 0]\nfollows = true\n"}) {
    const Scene scene = parse_scene(
        thick_rod_held + "[[load]]\nat = 0.2\nforce = [0, 1, 0]\n[[load]]\nat = 0.7\n" + load,
        "my.toml");
    for (const Model model : {Model::chain, Model::force}) {
      EXPECT_TRUE(
          has_all(error_of<InputError>([&] { return solve(scene, model); }),
                  {"my.toml: load.", "not supported by the polygons of models force and chain",
                   load.starts_with("torque") ? "the couple at 0.7 m" : "the load at 0.7 m"}));
    }
  }
}

TEST(Loads, AndOtherKeysThatSayNothingCostNoEvaluation) {
  const auto arch = [](const std::string& of_rod, const std::string& loads) {
    return parse_scene("[rod]\nlength = 1\ndiameter = \"6 mm\"\nmaterial = \"silicone\"\n" +
                           of_rod +
                           "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"20 deg\"\n"
                           "[[gripper]]\nat = 1\nposition = [0.6, 0, 0.1]\n"
                           "direction = \"-20 deg\"\n[[load]]\nat = 0.5\nforce = [0, -0.01, 0]\n" +
                           loads,
                       "my.toml");
  };
  const std::vector<std::array<std::string, 2>> cases = {
      {"", "torque = [0, 0, 0]\nfollows = false\n"},
      {"", "[[distributed_load]]\nforce_per_length = [0, 0, 0]\n[medium]\ndensity = 1e-300\n"},
      {"inner_diameter = 0\nnatural_curvature = [0, 0]\nnatural_twist = 0\n", ""},
      {"stretch = false\n", ""},
      {"stretch = \"auto\"\n", ""},
  };
  for (const Model model : {Model::energy, Model::exact}) {
    const Solution plain = solve(arch("", ""), model);
    for (const auto& [of_rod, loads] : cases) {
      const Solution with = solve(arch(of_rod, loads), model);
      EXPECT_EQ(with.evaluations, plain.evaluations) << to_string(model) << of_rod << loads;
      EXPECT_EQ(with.terms, plain.terms) << to_string(model) << of_rod << loads;
      EXPECT_LT(largest_difference(with, plain), 1e-15) << to_string(model) << of_rod << loads;
    }
  }
}

TEST(Loads, DragOnSegmentsComesToTheExactShapeAtSecondOrder) {
  Scene scene = parse_scene(thick_rod_held +
                                "[medium]\ndensity = 1000\nvelocity = [0.2, 0, 0.3]\n"
                                "normal_drag = 1.2\ntangential_drag = 0.1\n",
                            "my.toml");
  scene.force_model.stepper = Stepper::implicit;
  std::vector<double> errors;
  for (const int points : {12, 24, 48}) {
    scene.force_model.points = points;
    const Solution force = solve(scene, Model::force, {.rest_tolerance = 1e-8});
    const Solution exact = solve(scene, Model::exact, {}, force.shape.arc_length);
    errors.push_back(largest_difference(force, exact));
    EXPECT_TRUE(has_all(force.message, {"stability is not judged"}));
    EXPECT_EQ(force.status, energy_model::SolveStatus::not_verified);
    EXPECT_LT((force.grippers[0].force - exact.grippers[0].force).norm(), 5e-3);
  }
  EXPECT_NEAR(std::log(errors[0] / errors[2]) / std::log(4), 2, 0.3)
      << errors[0] << " " << errors[1] << " " << errors[2];
  EXPECT_LT(errors[2], 1e-3);
}

TEST(Loads, ACoupleInThePlaneIsForEnergyAndExact) {
  Scene scene = heavy_scene(0.5, 0);
  const double torque = 0.8 * std::numbers::pi * scene.bending_stiffness();
  scene.loads = {{.at = 1, .torque = {0, 0, torque}}};
  EXPECT_TRUE(scene.planar());
  const Solution energy = solve(scene, Model::energy);
  EXPECT_LT(largest_difference(energy, solve(scene, Model::exact)), 1e-9);
  EXPECT_TRUE(has_all(energy.message, {"in the plane alone"}));
}

}  // namespace
}  // namespace dlo::compare
