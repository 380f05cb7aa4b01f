// Tests of scenes of the benchmark set that move: their answers, causes of wrong motions, and
// programs that compute motions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "dlo/compare/shape.hpp"
#include "suite/answer.hpp"
#include "suite/battery.hpp"
#include "suite/cause.hpp"
#include "suite/committed_answer.hpp"
#include "suite/pack.hpp"

namespace dlo::compare {
namespace {

using testing::HasSubstr;

BatteryScene moving_scene(const std::string& id) {
  return chosen_scenes(builtin_battery(), {id}).front();
}

TEST(MotionAnswers, CommittedOnesAreThoseOfFreshOnesWithinTheirBounds) {
  const json before = committed_answer("motion_release");
  const json now = motion_json(certified_motion(moving_scene("motion_release")));
  ASSERT_EQ(before["times_s"], now["times_s"]);
  ASSERT_EQ(before["methods"], now["methods"]);
  const double bound = before["points_bound_m"];
  EXPECT_LT(bound, 2e-4 * moving_scene("motion_release").scene.length);
  for (std::size_t k = 0; k < now["frames_m"].size(); ++k) {
    for (std::size_t i = 0; i < now["frames_m"][k].size(); ++i) {
      ASSERT_LT((vector_of(before["frames_m"][k][i]) - vector_of(now["frames_m"][k][i])).norm(),
                bound);
    }
  }
}

// w at the tip is a cos(omega t), up to nonlinear terms at a = 0.01 l.
TEST(MotionAnswers, TheVibrationHasTheFrequencyOfItsClosedForm) {
  const json answer = committed_answer("motion_vibration");
  constexpr double lambda = 1.8751040687119611;
  const double l = 0.4;
  const double omega = lambda * lambda * std::sqrt(0.01 / 0.02) / (l * l);
  EXPECT_LT(answer["points_bound_m"], 1e-6 * l);
  for (std::size_t k = 0; k < answer["times_s"].size(); ++k) {
    const double time = answer["times_s"][k];
    EXPECT_NEAR(vector_of(answer["frames_m"][k].back()).y(), 0.01 * l * std::cos(omega * time),
                2e-3 * 0.01 * l);
  }
}

/// Returns a recording of the reference with a faster time, a lag, and damped motion about the rest
/// shape.
MarkerMotion recorded(const MotionReference& reference, double faster, double late, double decay) {
  MarkerMotion motion{.file = "made", .positions = {}};
  for (const double time : equal_arc_lengths(reference.end_time, reference.frames)) {
    for (const double s : equal_arc_lengths(reference.length, 9)) {
      const Eigen::Vector3d rest = reference.at_rest.at(0, s);
      const Eigen::Vector3d moved = reference.motion.at(faster * time - late, s);
      const double stays = std::isinf(decay) ? 0 : std::exp(-decay * time);
      motion.positions.push_back({time, s, rest + stays * (moved - rest)});
    }
  }
  return motion;
}

TEST(MotionCauses, NameWhatIsWrongAndNothingElse) {
  const MotionReference reference = motion_reference(moving_scene("motion_payload"));
  EXPECT_GT(reference.rms_displacement, 0.3 * reference.length);
  const auto expect = [&](const MarkerMotion& motion, const std::string& name, double factor) {
    EXPECT_GT(motion_error(reference, motion), 0.01) << name;
    const std::vector<Cause> causes = motion_causes(reference, motion);
    ASSERT_EQ(causes.size(), 1U) << name;
    EXPECT_EQ(causes[0].name, name);
    if (std::isfinite(factor)) EXPECT_NEAR(causes[0].factor, factor, 1e-2 * factor) << name;
  };
  expect(recorded(reference, 0.95, 0, 0), "frequency wrong", 0.95);
  expect(recorded(reference, 1.2, 0, 0), "frequency wrong", 1.2);
  expect(recorded(reference, 1, 0.06, 0), "late or early", 0.06 / reference.end_time);
  expect(recorded(reference, 1, 0, 0.5), "damped", std::exp(-0.5 * reference.end_time));
  expect(recorded(reference, 1, 0, INFINITY), "inertia ignored", NAN);
  expect(recorded(reference, 0, 0, 0), "does not move", NAN);
  EXPECT_LT(motion_error(reference, recorded(reference, 1, 0, 0)), 1e-9);
  EXPECT_TRUE(motion_causes(reference, recorded(reference, 1, 0, 0)).empty());
}

class MotionSuite : public PythonCommand {
 protected:
  /// Returns the entry of the scene motion_vibration in the card of mover.py with this defect.
  [[nodiscard]] json scene_card(const std::string& defect, const std::string& more = "",
                                int status = 0) const {
    return json_of("suite --points 6 --scenes motion_vibration" +
                       with_program("mover", "tests/compare/suite/mover.py " + defect) + more,
                   status)
        .at("cards")
        .at(0)
        .at("scenes")
        .at(0);
  }
};

TEST_F(MotionSuite, AProgramWithAMotionIsJudged) {
  const json right = scene_card("right");
  EXPECT_EQ(right.at("right"), true) << right.dump(1);
  EXPECT_TRUE(right.at("causes").empty()) << right.dump(1);
  // The linear solution neglects the axial displacement of the tip, about 0.5 w^2 / l.
  EXPECT_LT(right.at("runs").at(2).at("rms_over_length"), 5e-3);
  const json heavy = scene_card("heavy");
  EXPECT_EQ(heavy.at("right"), false);
  ASSERT_EQ(heavy.at("causes").size(), 1U);
  EXPECT_EQ(heavy.at("causes").at(0).at("name"), "frequency wrong");
  EXPECT_NEAR(heavy.at("causes").at(0).at("factor"), 0.9, 1e-3);
  EXPECT_EQ(scene_card("damped").at("causes").at(0).at("name"), "damped");
}

TEST_F(MotionSuite, OneWithoutIsNotSupportedAndHalfAMotionIsAFailure) {
  const json none = scene_card("static");
  EXPECT_EQ(none.at("status"), "not supported");
  EXPECT_THAT(none.at("runs").at(0).at("problem").get<std::string>(), HasSubstr("at rest"));
  const json half = scene_card("short", "", 3);
  EXPECT_EQ(half.at("status"), "failed");
  EXPECT_THAT(half.at("runs").at(0).at("problem").get<std::string>(),
              HasSubstr("5 frames from 0 to 0.2 s (allowed: 9 or more"));
}

TEST_F(MotionSuite, ABatteryTellsWhatItsMotionLacks) {
  std::ofstream(path("rod.toml"))
      << "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 1\n"
         "[[gripper]]\nat = 0\nposition = [0, 0, 0]\nhold = \"pin\"\n";
  const auto error_of = [&](const std::string& motion) {
    std::ofstream(path("battery.toml"))
        << "schema = \"dlo/suite/1\"\nversion = \"1\"\n[[scene]]\nfile = \"rod.toml\"\nclass = "
           "\"motion\"\nisolates = \"x\"\n[scene.motion]\n"
        << motion;
    const RunResult result = run("suite --with chain --battery " + path("battery.toml"));
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_THAT(error_of("begin = \"rod.toml\"\nframes = 5\n"), HasSubstr("until"));
  EXPECT_THAT(error_of("begin = \"rod.toml\"\nuntil = \"1 s\"\nframes = 2\n"),
              HasSubstr("battery.toml:10: scene.motion.frames"));
}

}  // namespace
}  // namespace dlo::compare
