// Tests of recorded motions compared with the scene's rod. The recordings have a known lag, offset
// and noise; they are made by an independent solve for each time, not by the motion of the check.

#include "recording/motion_check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

Scene swung_rod() { return load_scene(std::string(DLO_DATA) + "/scenes/swung_rod.toml"); }

/// Returns a cable between two clamps, one of which moves away and up. `error` returns what is
/// added to its position [m] at a time [s].
Scene moving_clamp(const std::function<Eigen::Vector3d(double)>& error = {}) {
  std::string text =
      "gravity = [0, 0, -9.81]\n[rod]\nlength = 0.6\nbending_stiffness = 2e-3\n"
      "mass_per_length = 0.05\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = [1, 0, 0]\n"
      "[[gripper]]\nat = 0.6\ndirection = [1, 0, 0]\n";
  for (int k = 0; k <= 10; ++k) {
    const double t = 0.2 * k;
    Eigen::Vector3d at(0.42 + 0.03 * t, 0.06 * t * t / 4, 0.05 * std::sin(t));
    if (error) at += error(t);
    text += fmt::format("[[gripper.pose]]\ntime = {}\nposition = [{}, {}, {}]\n", t, at.x(), at.y(),
                        at.z());
  }
  return parse_scene(text, "led.toml");
}

/// Returns count + 1 times from 0 to `end` [s] at unequal distances.
std::vector<double> uneven_times(double end, int count) {
  std::vector<double> times;
  for (int k = 0; k <= count; ++k) {
    const double share = static_cast<double>(k) / count;
    times.push_back(end * (share + 0.03 * std::sin(5 * std::numbers::pi * share)));
  }
  return times;
}

void add_row(MarkerMotion& motion, double time, const std::vector<double>& markers,
             const Eigen::Matrix3Xd& points) {
  for (std::size_t i = 0; i < markers.size(); ++i) {
    motion.positions.push_back({time, markers[i], points.col(static_cast<Eigen::Index>(i))});
  }
}

/// Returns a recording of the rod at rest at `time - lag`, which is solved separately for each
/// time.
MarkerMotion at_rest(const Scene& scene, const std::vector<double>& times,
                     const std::vector<double>& markers, double lag = 0) {
  MarkerMotion motion{.file = "made.csv", .positions = {}};
  for (const double time : times) {
    add_row(motion, time, markers,
            solve(scene_at(scene, time - lag), Model::energy, {}, markers).shape.points);
  }
  return motion;
}

void translate_markers(MarkerMotion& motion, const Eigen::Vector3d& by) {
  for (MarkerPosition& at : motion.positions) at.position += by;
}

const std::vector<double> marker_positions = {0.07, 0.15, 0.23, 0.31, 0.39};
constexpr double close_to_rod = 1e-5;  // error of interpolation between frames [m]
/// Damping that makes a rod with inertia nearly quasi-static, in few steps, for tests of other
/// properties.
constexpr RodDamping strong_damping{.material = 0.2};

TEST(MotionCheck, TheRodAtRestPassesAtTimesBetweenTheModelsFrames) {
  const Scene scene = swung_rod();
  const MotionCheck check =
      check_motion(scene, at_rest(scene, uneven_times(0.8, 20), marker_positions));
  EXPECT_TRUE(check.passes);
  EXPECT_LT(check.errors.rms_m, close_to_rod);
  EXPECT_EQ(check.errors.frames.size(), 21U);
  EXPECT_EQ(check.points, 105U);
  EXPECT_TRUE(check.causes.empty());
  EXPECT_EQ(check.nearer, MotionModel::at_rest);
  EXPECT_GT(check.with_inertia_rms_m, 0.05 * scene.length);
  EXPECT_TRUE(check.tolerance.by_default);
}

TEST(MotionCheck, FindsTheLagOfARecording) {
  const Scene scene = swung_rod();
  for (const double lag : {0.03, -0.02}) {
    const MotionCheck check =
        check_motion(scene, at_rest(scene, uneven_times(0.8, 20), marker_positions, lag));
    EXPECT_FALSE(check.passes) << check.reason;
    EXPECT_NEAR(check.lag, lag, 1e-4);
    EXPECT_LT(check.lag_rms_m, 1e-4);
    ASSERT_EQ(check.causes.size(), 1U);
    EXPECT_EQ(check.causes.front().words, lag > 0 ? "it is 30 ms late" : "it is 20 ms early");
  }
}

// The lag is computed without the early points, whose past is unknown after --from.
TEST(MotionCheck, FindsNoLagThatOnlyOmitsWrongPoints) {
  const Scene scene = swung_rod();
  std::vector<double> times;
  for (int k = 0; k <= 20; ++k) times.push_back(0.2 + 0.03 * k);
  MarkerMotion motion = at_rest(scene, times, marker_positions);
  for (MarkerPosition& at : motion.positions) at.position.x() += at.time < 0.3 ? 0.02 : 0;
  for (MarkerPosition& at : motion.positions) at.position.z() += 1e-4 * std::sin(99 * at.time);
  EXPECT_TRUE(std::isnan(check_motion(scene, motion, {.from = 0.2}).lag));
}

TEST(MotionCheck, FindsWhereARecordingIsDisplaced) {
  const Scene scene = swung_rod();
  MarkerMotion motion = at_rest(scene, uneven_times(0.8, 20), marker_positions);
  const Eigen::Vector3d by(6e-3, -2e-3, 3e-3);
  translate_markers(motion, by);
  const MotionCheck check = check_motion(scene, motion);
  EXPECT_NEAR(check.errors.rms_m, by.norm(), close_to_rod);
  EXPECT_NEAR(check.errors.largest_m, by.norm(), 3 * close_to_rod);
  EXPECT_TRUE(std::isnan(check.lag));
  ASSERT_EQ(check.causes.size(), 1U);
  EXPECT_EQ(check.causes.front().words, "the whole recording is displaced by [6, -2, 3] mm");
  MarkerMotion late = at_rest(scene, uneven_times(0.8, 20), marker_positions, 0.02);
  translate_markers(late, by);
  const MotionCheck both = check_motion(scene, late);
  ASSERT_FALSE(both.causes.empty());
  EXPECT_EQ(both.causes.front().words,
            "the whole recording is displaced by [6, -2, 3] mm, and it is 20 ms late");
}

TEST(MotionCheck, SaysThatInertiaIsMissing) {
  const Scene scene = swung_rod();
  const MotionCheck check =
      check_motion(scene, at_rest(scene, uneven_times(0.8, 40), marker_positions),
                   {.model = MotionModel::with_inertia, .solve = {.time_limit = 1000}});
  EXPECT_FALSE(check.passes);
  ASSERT_EQ(check.causes.size(), 1U);
  EXPECT_EQ(check.causes.front().words, "it is quasi-static: its inertia is missing");
  EXPECT_LT(check.causes.front().rms_m, close_to_rod);
  EXPECT_EQ(check.nearer, MotionModel::at_rest);
}

// The recording has so many rows that they are thinned. The marker at the end of the rod, with
// amplitude 1 compared with 0.1, has a lag of 0.05 s, the other one has none. The least squares
// solution for small lags is 0.05 / 1.01.
TEST(LagSearch, ThinsTimesAndNoMarkers) {
  const auto at = [](double time, double s) { return Eigen::Vector3d(0, s * std::sin(time), 0); };
  std::vector<Eigen::Matrix3Xd> frames;
  for (int k = 0; k <= 1000; ++k) {
    Eigen::Matrix3Xd& frame = frames.emplace_back(3, 4);
    for (int i = 0; i < 4; ++i) frame.col(i) = at(0.01 * k, i / 3.0);
  }
  const ModelMotion model(0, 10, 1, std::move(frames));
  MarkerMotion recorded{.file = "late.csv", .positions = {}};
  for (int k = 0; k <= 15'000; ++k) {
    const double time = 1 + 5e-4 * k;
    recorded.positions.push_back({time, 0.1, at(time, 0.1)});
    recorded.positions.push_back({time, 1, at(time - 0.05, 1)});
  }
  const auto lag = best_lag(recorded, model, -1, Displacement::none);
  ASSERT_TRUE(lag);
  EXPECT_NEAR(lag->lag, 0.05 / 1.01, 1e-4);
}

TEST(MotionCheck, MeasuresNoiseAndFindsNoCauseInIt) {
  const Scene scene = swung_rod();
  MarkerMotion motion = at_rest(scene, uneven_times(0.8, 80), marker_positions);
  constexpr double deviation = 1e-3;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, deviation);
  for (MarkerPosition& at : motion.positions) {
    for (double& coordinate : at.position) coordinate += noise(random);
  }
  const MotionCheck check = check_motion(
      scene, motion, {.damping = strong_damping, .tolerance = ShapeTolerance{.allowed_m = 1e-3}});
  // Three standard deviations of the RMS of 1215 coordinates are 6 %.
  EXPECT_NEAR(check.errors.rms_m, deviation * std::sqrt(3), 0.06 * deviation * std::sqrt(3));
  EXPECT_FALSE(check.passes);
  EXPECT_TRUE(check.causes.empty()) << check.causes.front().words;
  EXPECT_TRUE(std::isnan(check.lag));
}

TEST(MotionCheck, SaysWhichFrameAndWhichPartOfTheRod) {
  const Scene scene = swung_rod();
  MarkerMotion motion = at_rest(scene, uneven_times(0.8, 20), {0.05, 0.35});
  MarkerPosition& wrong = motion.positions[2 * 13 + 1];
  wrong.position.z() += 0.02;
  const MotionCheck check = check_motion(scene, motion, {.damping = strong_damping});
  EXPECT_EQ(check.errors.worst_frame, 13U);
  EXPECT_NEAR(check.worst_frame_error().rms_m, 0.02 / std::sqrt(2), close_to_rod);
  EXPECT_NEAR(check.worst_frame_error().largest_m, 0.02, close_to_rod);
  EXPECT_EQ(check.worst_frame_error().largest_at_m, 0.35);
  EXPECT_EQ(check.worst_frame_error().time, wrong.time);
  ASSERT_EQ(check.errors.thirds.size(), 2U);  // the middle has no marker
  EXPECT_LT(check.errors.thirds[0].rms_m, close_to_rod);
  EXPECT_NEAR(check.errors.thirds[1].rms_m, 0.02 / std::sqrt(21), close_to_rod);
  ASSERT_EQ(check.errors.markers.size(), 2U);
  EXPECT_NEAR(check.errors.markers[1].largest_m, 0.02, close_to_rod);
  const MotionCheck by_largest =
      check_motion(scene, motion,
                   {.damping = strong_damping,
                    .tolerance = ShapeTolerance{.allowed_m = 0.015, .largest = true}});
  EXPECT_FALSE(by_largest.passes);
  EXPECT_NEAR(by_largest.judged_m, 0.02, close_to_rod);
}

TEST(MotionCheck, FindsAGripperThatIsElsewhere) {
  const std::vector<double> markers = {0.1, 0.2, 0.3, 0.4, 0.5};
  const std::vector<double> times = uneven_times(2, 20);
  const Scene displaced = moving_clamp([](double) { return Eigen::Vector3d(4e-3, 8e-3, -6e-3); });
  const MotionCheckRequest request{
      .damping = strong_damping, .frame_rate = 15, .tolerance = ShapeTolerance{.allowed_m = 1e-3}};
  const MotionCheck constant =
      check_motion(moving_clamp(), at_rest(displaced, times, markers), request);
  ASSERT_FALSE(constant.causes.empty());
  EXPECT_TRUE(constant.causes.front().words.starts_with("gripper 2 is displaced b"));
  EXPECT_LT(constant.causes.front().rms_m, 0.1 * constant.errors.rms_m);
  const Scene off_path = moving_clamp(
      [](double t) { return Eigen::Vector3d(0, 0.01 * std::sin(6 * t), 0.01 * std::sin(3 * t)); });
  const MotionCheck path = check_motion(moving_clamp(), at_rest(off_path, times, markers), request);
  ASSERT_FALSE(path.causes.empty());
  EXPECT_TRUE(path.causes.front().words.starts_with("gripper 2 has another path"));
}

}  // namespace
}  // namespace dlo::compare
