// Tests of calibrate for a chain and for the force model, as a user runs it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "calibrate_fixture.hpp"

namespace dlo::compare {
namespace {

TEST_F(CalibrateCommand, TellsTheJointsOfAChain) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string chain =
      words({"calibrate", a, "--shape", write_exact_shape(a, "a.csv"), "--segments 12"});
  const json chains = json_of(chain).at("chains");
  ASSERT_EQ(chains.size(), 3U);
  EXPECT_EQ(chains[0].at("clamp"), "hinge");
  EXPECT_EQ(chains[2].at("clamp"), "middle");
  EXPECT_NEAR(chains[2].at("over_bending_stiffness_per_length"), 1, 0.02);
  expect_error(words({"calibrate", a, "--shape", path("a.csv"), "--segments 3"}), 2,
               {"--segments", "3"});
  // The chain approximates the rod of the scene, and the shape is that of the same rod.
  const std::string own = words({"calibrate", a, "--segments 12"});
  const json bare = json_of(own).at("chains");
  ASSERT_EQ(bare.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const char* const joint = "joint_stiffness_Nm_per_rad";
    EXPECT_NEAR(bare[i].at(joint).get<double>() / chains[i].at(joint).get<double>(), 1, 1e-3);
  }
  expect_error(own + " --format csv", 2, {"--segments", "csv"});
  expect_error(words({"calibrate", a, "--segments", path("none.csv")}), 2, {"none.csv"});
}

TEST_F(CalibrateCommand, WritesParametersThatTheOtherCommandsRead) {
  const std::string a = scene_of("a.toml", "5 GPa", 0);
  const std::string b = scene_of("b.toml", "5 GPa", -30);
  for (const std::string law : {"hooke", "paper"}) {
    const std::string file = path(law + ".toml");
    const std::string calibrate = words({"calibrate", a, "--holdout", b, "--law", law});
    EXPECT_TRUE(has_all(output_of(words({calibrate, "-o", file})), {"hold-out"}));
    const json fit = json_of(calibrate);
    const json compared = json_of(words({"compare", b, "--parameters", file})).at("cases")[0];
    EXPECT_EQ(compared.at("law"), law);
    EXPECT_EQ(compared.at("points"), fit.at("parameters").at("points"));
    EXPECT_NEAR(compared.at("deviation").at("rms_over_length"),
                fit.at("deviation").at("worst_holdout_rms_over_length"), 1e-7);
    EXPECT_NEAR(compared.at("parameters").at("c_F").get<double>() /
                    fit.at("parameters").at("c_F").get<double>(),
                1, 1e-8);
    // An option on the command line overrides the file.
    EXPECT_EQ(json_of(words({"solve", a, "--model chain --parameters", file, "--points 9"}))
                  .at("points_m")
                  .size(),
              9U);
  }
}

TEST_F(CalibrateCommand, TellsWhatMadeTheTargetMissed) {
  const std::string stiff = scene_of("a.toml", "5 GPa", 0);
  const auto missed = [&](const std::string& arguments) {
    const RunResult result = run("calibrate " + arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    return result.out;
  };
  // The error is due to the number of segments, not to stretch.
  const std::string coarse = missed(stiff + " --target 0.01% --points 8");
  EXPECT_TRUE(has_all(coarse, {"N = 8 is too few"}));
  EXPECT_TRUE(has_none(coarse, {"A E: the rod"}));
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
  EXPECT_TRUE(has_all(fit.at("why_missed")[0].get<std::string>(), {"c_c is A E"}));
  EXPECT_TRUE(has_all(missed(stiff + " --law paper --target 0.001%"), {"law paper"}));
  // The parameter file states the source of c_c and whether it suffices.
  const std::string toml =
      run("calibrate " + soft + " --target 0.01% --points 24 --format toml").out;
  EXPECT_TRUE(has_all(toml, {"# Target 0.01 %: not reached."}));
  EXPECT_TRUE(has_all(toml, {"stretch stiffness: A E of the rod\n"}));
}

TEST_F(CalibrateCommand, KeepsAStepperThatHasNoParameters) {
  const std::string scene = scene_of("wire.toml", "5 MPa", 20);
  const std::string file = path("parameters.toml");
  for (const std::string stepper : {"implicit", "verlet"}) {
    EXPECT_TRUE(has_all(
        output_of("calibrate " + scene + " --points 12 --stepper " + stepper + " -o " + file),
        {" " + stepper + "\n"}));
    const std::string text = read(file);
    EXPECT_TRUE(has_all(text, {"stepper = \"" + stepper + "\"\n"}));
    EXPECT_TRUE(has_none(text, {"c_F"}));
    succeeds("solve " + scene + " --model force --parameters " + file);
  }
}

}  // namespace
}  // namespace dlo::compare
