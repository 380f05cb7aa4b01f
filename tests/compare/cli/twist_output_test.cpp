// Tests of commands on a rod that grippers twist, by models with and without twist.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

struct TwistCommand : Command {
  static std::string wire() { return shipped_scene("twisted_wire"); }
};

TEST_F(TwistCommand, ModelsThatHaveNoTwistSaySo) {
  for (const std::string model : {"chain", "force"}) {
    const std::string solve = "solve " + wire() + " --law paper --model " + model;
    const RunResult text = run(solve);
    ASSERT_EQ(text.status, 0) << text.err;
    EXPECT_TRUE(has_all(text.out, {"\nneglected ", " twist\n"}));
    EXPECT_EQ(text.err, "");
    const json document = json_of(solve);
    EXPECT_EQ(document.at("neglected"), json({"twist"}));
    EXPECT_FALSE(document.contains("twist"));
    EXPECT_FALSE(document.at("grippers")[0].contains("axial_torque_Nm"));
    const RunResult csv = run(solve + " --format csv");
    EXPECT_TRUE(has_all(csv.err, {"model " + model + " neglects the twist"}));
  }
}

TEST_F(TwistCommand, ModelsOfThePolygonHaveItWithTheLawHooke) {
  const json rod = json_of("solve " + wire());
  const double torque = rod.at("twist").at("parts")[0].at("torque_Nm").get<double>();
  for (const std::string model : {"chain", "force"}) {
    const std::string solve = "solve --points 60 --model " + model + " " + wire();
    const std::string text = output_of(solve);
    EXPECT_TRUE(has_none(text, {"neglected"}));
    EXPECT_TRUE(has_all(text, {"\ntwist parts\n"}));
    const json document = json_of(solve);
    EXPECT_FALSE(document.contains("neglected"));
    const json& part = document.at("twist").at("parts")[0];
    EXPECT_NEAR(part.at("torque_Nm"), torque, 0.01 * torque);
    EXPECT_NEAR(document.at("grippers")[1].at("axial_torque_Nm"), torque, 0.01 * torque);
    EXPECT_EQ(run(solve + " --format csv").err, "");
  }
}

TEST_F(TwistCommand, CommandsThatUseThemSaySo) {
  const std::string note =
      "the grippers hold twist, which models chain and force neglect with the law paper";
  const std::vector<std::string> commands = {
      "compare --no-modulus --law paper --format csv ",
      "regress --update --law paper --baseline " + path("b.toml") + " "};
  for (const std::string& command : commands) {
    EXPECT_TRUE(has_all(run(command + wire()).err, {note})) << command;
  }
  // The stability map and tracking neglect twist with any bending law.
  const std::string map = "stability --map cF-cc --columns 2 --rows 4 --map-steps 500 ";
  EXPECT_TRUE(has_all(run(map + wire()).err, {"the grippers hold twist, which the map neglects"}));
  EXPECT_TRUE(has_all(run("bench --seconds 0.1 --repeats 1 " + wire()).err,
                      {"the grippers hold twist, which tracking by the force model neglects"}));
}

TEST_F(TwistCommand, AComparisonSaysThatTheForceModelHasNone) {
  const json document = json_of("compare --no-modulus --law paper " + wire());
  EXPECT_EQ(document.at("cases")[0].at("neglected"), json({"twist"}));
  EXPECT_GT(document.at("cases")[0].at("budget").at("twist_m").get<double>(), 0.01);
  const json hooke = json_of("compare --no-modulus " + wire());
  EXPECT_FALSE(hooke.at("cases")[0].contains("neglected"));
  EXPECT_FALSE(hooke.at("cases")[0].at("budget").contains("twist_m"));
}

TEST_F(TwistCommand, TheEnergyModelGivesTorqueAndEnergyOfTheTwist) {
  const json document = json_of("solve " + wire());
  EXPECT_FALSE(document.contains("neglected"));
  EXPECT_TRUE(document.at("one_branch_followed").get<bool>());
  EXPECT_TRUE(has_all(output_of("solve " + wire()), {"others with these turns may be lower"}));
  const json& part = document.at("twist").at("parts")[0];
  // The wire bends out of its plane, which converts a part of the prescribed half turn into writhe.
  const double angle = part.at("angle_rad").get<double>();
  EXPECT_GT(angle, pi / 2);
  EXPECT_LT(angle, pi);
  const double torque = part.at("torque_Nm").get<double>();
  EXPECT_NEAR(torque, 7.93e-3 * angle / 0.5, 1e-9 * torque);
  EXPECT_NEAR(document.at("energy_J").at("twisting"), torque * angle / 2, 1e-9 * torque * angle);
  EXPECT_NEAR(document.at("grippers")[1].at("axial_torque_Nm"), torque, 1e-6 * torque);
  EXPECT_NEAR(json_of("solve --model exact " + wire()).at("twist").at("total_rad"), angle, 1e-8);
  const json straight = json_of("solve " + steel());
  EXPECT_FALSE(straight.contains("twist") || straight.contains("one_branch_followed"));
  EXPECT_FALSE(straight.at("grippers")[0].contains("axial_torque_Nm"));
}

}  // namespace
}  // namespace dlo::compare
