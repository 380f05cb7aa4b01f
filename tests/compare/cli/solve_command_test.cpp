// Tests of the command `dlo solve`, and of `dlo compare` with the same scenes.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"
#include "rope_beside_peg.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string back_bent_rod = steel_rod + gripper_text("direction = \"-175 deg\"");

const std::string two_grippers = R"(gravity = [0, -9.81, 0]
rod = { length = "50 cm", diameter = "2 mm", material = "spring_steel" }
gripper = [{ at = 0, position = [0, 0, 0], direction = "30 deg" },
           { at = "40 cm", position = [0.3, 0.05, 0.1], hold = "pin" }]
load = [{ at = "20 cm", force = [0, -0.5, 0] }]
obstacle = [{ point = [0, -0.3, 0], normal = [0, 1, 0] }]
force_model = { points = 40 }
)";

TEST_F(Command, SolveWritesTheContractsJsonForEveryModel) {
  for (const std::string model : {"energy", "chain", "exact", "force"}) {
    const RunResult result =
        run("solve " + steel() + " --model " + model + " --samples 11 --format json");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const json document = json::parse(result.out);
    EXPECT_EQ(document.at("schema"), "dlo/solve/1");
    EXPECT_EQ(document.at("model"), model);
    EXPECT_EQ(document.at("converged"), true);
    const json& error = document.at("error_estimate_m");
    EXPECT_EQ(error.is_null(), model == "chain" || model == "exact") << error;
    EXPECT_LT(error.is_null() ? 0 : error.get<double>(), 1.01e-7);
    ASSERT_EQ(document.at("points_m").size(), 11U);
    EXPECT_EQ(document.at("arc_length_m").back(), 0.5);
    const json& energy = document.at("energy_J");
    EXPECT_NEAR(energy.at("total"),
                energy.at("bending").get<double>() + energy.at("gravity").get<double>() +
                    energy.at("load").get<double>() + energy.at("stretch").get<double>(),
                1e-15);
    EXPECT_NEAR(document.at("grippers")[0].at("force_N")[1], 0.121735143, 1e-6);
    EXPECT_GE(document.at("solver").at("wall_s").get<double>(), 0);
  }
}

TEST_F(Command, TooFewPointsForTheGrippersIsBadInput) {
  // The rod ends 2 cm beyond the pin, so half a segment must be at most 2 cm long.
  const std::string text = replaced(two_grippers, "40 cm", "48 cm");
  expect_error("solve " + scene(text) + " --model chain --points 13", 2,
               {"force_model.points = 13", "at least 14 points"});
  succeeds("solve " + scene(text) + " --model chain --points 14");
}

TEST_F(Command, ExplainSaysWhyThereIsNoN) {
  const std::string moving = scene(back_bent_rod +
                                   "[[obstacle]]\nnormal = [0, 1, 0]\n"
                                   "pose = [{ time = 0, point = [0, -0.03, 0] }, "
                                   "{ time = 2, point = [0, -0.2, 0] }]\n");
  EXPECT_TRUE(
      has_all(output_of("solve " + moving + " --explain"), {"the rod touches an obstacle"}));
}

TEST_F(Command, JsonHasThePlan) {
  const std::string far =
      scene(back_bent_rod + "[[obstacle]]\npoint = [0, -0.6, 0]\nnormal = [0, 1, 0]\n");
  for (const std::string command : {"solve ", "compare "}) {
    const json document = json_of(command + far);
    const json& plan =
        command == "solve " ? document.at("plan") : document.at("cases")[0].at("plan");
    EXPECT_EQ(plan.at("geometry"), "planar");
    EXPECT_EQ(plan.at("obstacles")[0].at("in_reach"), false);
    EXPECT_NEAR(plan.at("obstacles")[0].at("clearance_m"), 0.099, 1e-12);
    EXPECT_GT(plan.at("neglected")[0].at("bound_m").get<double>(), 0);
  }
  // The obstacle is out of reach, so model exact, which does not detect contact, accepts the scene.
  succeeds("solve " + far + " --model exact");
  expect_error("solve " + far + " --target-error 0", 2, {"--target-error"});
}

// A hanging strip of rubber extends by w l^2 / (2 EA), with the weight per length w.
TEST_F(Command, ModelExactIsTheDefaultAndTheReferenceOfARodThatStretches) {
  const std::string stretches = scene(
      "gravity = [0, -10, 0]\n[rod]\nlength = 2\ndiameter = 0.01\nstretch = true\n"
      "material = { youngs_modulus = \"2 MPa\", density = 1000 }\n" +
      gripper_text("direction = \"-90 deg\""));
  const json document = json_of("solve " + stretches + " --samples 3");
  EXPECT_EQ(document.at("model"), "exact");
  EXPECT_NEAR(document.at("points_m")[2][1], -2.01, 1e-9);
  EXPECT_EQ(json_of("solve " + stretches + " --model chain").at("model"), "chain");
  expect_error("solve " + stretches + " --model energy", 2, {"stretch = true"});
  expect_error("solve " + stretches + " --all", 2, {"--all", "stretch"});
  const std::string file = solved_file(stretches + " --samples 41");
  const std::string check = "check " + stretches + " --shape " + file + " --tolerance 1e-6";
  EXPECT_EQ(json_of(check).at("state").at("searched"), false);
  const json fit = json_of("calibrate " + stretches + " --shape " + file);
  EXPECT_NEAR(fit.at("youngs_modulus_Pa").get<double>() / 2e6, 1, 1e-3) << fit;
}

TEST_F(Command, SolveNearAFileIsTheEquilibriumBesideThatFile) {
  const std::string path = scene(rope_beside_peg);
  const std::string over = write("over.csv",
                                 "x,y,z\n-0.35,0.06,0\n-0.01,0.043,0\n0.03,0.03,0\n0.043,0,0\n"
                                 "0.043,-0.3,0\n0.043,-0.59,0\n");
  const json near = json_of("solve " + path + " --near " + over);
  EXPECT_EQ(near.at("converged"), true);
  ASSERT_EQ(near.at("contacts").size(), 1);
  const double tip = near.at("points_m").back()[1];
  const double held = std::abs(near.at("grippers")[0].at("force_N")[0].get<double>());
  EXPECT_NEAR(held, 9.81 * (1.5 + 0.06 * (0.06 - tip)), 0.05);
  EXPECT_TRUE(json_of("solve " + path).at("contacts").empty());
  EXPECT_TRUE(has_all(run("solve " + path + " --model exact --near " + over).err,
                      {"--near: only model energy"}));
  EXPECT_NE(run("solve " + path + " --all --near " + over).status, 0);
}

TEST_F(Command, SolveReturnsAnEquilibriumByItsNumberInTheListOfAll) {
  const std::string path = scene(rope_beside_peg);
  const json all = json_of("solve " + path + " --all").at("equilibria");
  const json first = json_of("solve " + path + " --equilibrium 1");
  EXPECT_TRUE(first.at("contacts").empty());
  const json second = json_of("solve " + path + " --equilibrium 2");
  EXPECT_EQ(second.at("energy_J").at("total"), all.at(1).at("energy_J"));
  EXPECT_EQ(second.at("smallest_eigenvalue"), all.at(1).at("smallest_eigenvalue"));
  // All that acts on the rod is in balance: the load and the weight hang from pin and peg.
  ASSERT_EQ(second.at("contacts").size(), 1);
  const double pin = second.at("grippers")[0].at("force_N")[1];
  const double peg = second.at("contacts")[0].at("force_N")[1];
  EXPECT_NEAR(pin + peg, 9.81 * (1.5 + 0.06), 1e-6);
  EXPECT_TRUE(has_all(run("solve " + path + " --equilibrium 2").out,
                      {"\nobstacles\n  obstacle  force [N]\n         1  ["}));
  const std::string beyond = std::to_string(all.size() + 1);
  EXPECT_TRUE(has_all(run("solve " + path + " --equilibrium " + beyond).err,
                      {"equilibrium " + beyond + ": the search found"}));
  EXPECT_TRUE(has_all(run("solve " + path + " --model exact --equilibrium 2").err,
                      {"--equilibrium: only model energy"}));
}

TEST_F(Command, SolveStatesTheStableEquilibriaThatItsSearchFound) {
  const std::string path = scene(rope_beside_peg);
  EXPECT_TRUE(has_all(run("solve " + path).out, {"\nstable energies ", "\npassing starts "}));
  const json lowest = json_of("solve " + path);
  EXPECT_EQ(lowest.at("passing_starts"), 2);
  EXPECT_EQ(lowest.at("stable_energies_J"), json::array({lowest.at("energy_J").at("total")}));
  const json all = json_of("solve " + path + " --all");
  json energies = json::array();
  for (const json& equilibrium : all.at("equilibria")) {
    if (equilibrium.at("stable")) energies.push_back(equilibrium.at("energy_J"));
  }
  ASSERT_GT(energies.size(), 1);
  EXPECT_EQ(all.at("stable_energies_J"), energies);
  EXPECT_TRUE(json_of("solve " + path + " --model chain").at("stable_energies_J").empty());
  const json state = json_of("compare " + path + " --no-modulus").at("cases")[0].at("state");
  json listed = json::array({state.at("energy_J")});
  for (const json& other : state.at("others")) {
    EXPECT_TRUE(other.at("stable"));
    listed.push_back(state.at("energy_J").get<double>() +
                     other.at("energy_difference_J").get<double>());
  }
  ASSERT_EQ(listed.size(), energies.size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    EXPECT_NEAR(listed[i], energies[i].get<double>(), 1e-9);
  }
}

}  // namespace
}  // namespace dlo::compare
