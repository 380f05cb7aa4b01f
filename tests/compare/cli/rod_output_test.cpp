// Tests of the output for rods given by EI and for intrinsically curved rods.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

class RodCommand : public Command {
 protected:
  static std::string hose() { return shipped_scene("spring_hose"); }

  /// Writes the scene of a rod that is given by EI and mass per length, and returns its path.
  std::string by_stiffness(const std::string& EI) {
    return write("rod.toml",
                 "[rod]\nlength = 1\nmass_per_length = \"45 g/m\"\nbending_stiffness = " + EI +
                     "\n" + gripper_text("direction = \"20 deg\""));
  }
};

TEST_F(RodCommand, SolveSaysThatTheTorsionalStiffnessIsAssumed) {
  for (const std::string model : {"energy", "chain"}) {
    const json document = json_of("solve --model " + model + " " + hose());
    const json& assumed = document.at("assumed");
    EXPECT_NEAR(assumed.at("torsional_stiffness_Nm2"), 0.08 / 1.3, 1e-15);
    EXPECT_EQ(assumed.at("poisson_ratio"), 0.3);
  }
  const json straight = json_of("solve " + by_stiffness("0.08"));
  EXPECT_FALSE(straight.contains("assumed"));
}

TEST_F(RodCommand, SolveShowsARodThatIsAboutToBuckleAndItsNeutralDirections) {
  constexpr double self_buckling = 7.837347;
  const std::string file = scene(fmt::format(
      "gravity = [0, -9.81, 0]\n[rod]\nlength = 1\nmass_per_length = 0.045\n"
      "bending_stiffness = {}\n{}",
      0.045 * 9.81 / (self_buckling * (1 - 1e-9)), gripper_text("direction = [0, 1, 0]")));
  const RunResult text = run("solve " + file);
  EXPECT_EQ(text.status, 3);
  const std::string why = "next to a fold or bifurcation: 2 neutral directions";
  EXPECT_TRUE(has_all(text.err, {why}));
  const json result = json_of("solve " + file, 3);
  EXPECT_EQ(result.at("status"), "near_singular");
  EXPECT_EQ(result.at("converged"), false);
  EXPECT_EQ(result.at("neutral_directions"), 2);
  EXPECT_GT(result.at("error_estimate_m").get<double>(), 0);
  EXPECT_FALSE(json_of("solve " + by_stiffness("0.08")).contains("neutral_directions"));
}

TEST_F(RodCommand, ComparesByTheStiffnessThatIsGiven) {
  const std::string rod = by_stiffness("0.08");
  succeeds("solve " + rod + " --format csv -o " + path("shape.csv"));
  const json check = json_of("check " + rod + " --shape " + path("shape.csv"));
  EXPECT_NEAR(check.at("effective_bending_stiffness_Nm2"), 0.08, 1e-6);
  EXPECT_FALSE(check.contains("effective_modulus_Pa"));
}

TEST_F(RodCommand, CalibrateFindsTheStiffnessThatIsGiven) {
  succeeds("solve " + by_stiffness("0.08") + " --format csv -o " + path("shape.csv"));
  const std::string calibrate =
      "calibrate " + by_stiffness("0.03") + " --shape " + path("shape.csv");
  const json document = json_of(calibrate);
  EXPECT_NEAR(document.at("bending_stiffness_Nm2"), 0.08, 1e-6);
  EXPECT_LE(document.at("interval_95_Nm2")[0].get<double>(), 0.0800001);
  EXPECT_FALSE(document.contains("youngs_modulus_Pa"));
  EXPECT_EQ(run(calibrate + " --format csv").out.rfind("bending_stiffness_Nm2,low_Nm2,", 0), 0U);
  succeeds(calibrate + " -o " + path("fit.toml"));
  // The written lines are keys of the table [rod] of a scene.
  const Scene fitted = parse_scene("[rod]\nlength = 1\n" + read(path("fit.toml")) +
                                       "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = 0\n",
                                   "fitted.toml");
  EXPECT_NEAR(fitted.bending_stiffness(), 0.08, 1e-6);
  EXPECT_DOUBLE_EQ(fitted.mass_per_length(), 0.045);
}

TEST_F(RodCommand, AModelWithoutNaturalCurvatureSaysSoAndWhatItCosts) {
  const std::string paper = hose() + " --law paper";
  const RunResult chain = run("solve --model chain " + paper);
  EXPECT_TRUE(has_all(chain.out, {"\nneglected ", " natural curvature\n"}));
  EXPECT_TRUE(has_all(run("compare --no-modulus --format csv " + paper).err,
                      {"intrinsically curved, which models chain and force neglect with the law"}));
  const json entry = json_of("compare --no-modulus " + paper).at("cases")[0];
  EXPECT_EQ(entry.at("neglected"), json({"natural curvature"}));
  // The hose without load is a circle. If its natural curvature is neglected, the deviation is more
  // than 0.1 m.
  const json& budget = entry.at("budget");
  EXPECT_GT(budget.at("natural_curvature_m").get<double>(), 0.1);
  EXPECT_FALSE(budget.contains("twist_m"));
  const json hooke = json_of("compare --no-modulus " + hose()).at("cases")[0];
  EXPECT_FALSE(hooke.contains("neglected"));
  EXPECT_FALSE(hooke.at("budget").contains("natural_curvature_m"));
  // With natural curvature the force model differs from the rod only by its discretisation.
  EXPECT_LT(hooke.at("deviation").at("rms_over_length").get<double>(), 2e-3);
}

}  // namespace
}  // namespace dlo::compare
