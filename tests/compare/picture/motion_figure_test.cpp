// Tests of the picture of a recorded motion: recordings that equal the rod's motion, are late or
// displaced, in the plane and in space, and one of a straight rod.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "figure/gnuplot.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

/// Returns a rod between two clamps, one of which moves; `way` is its poses at 0 and 1 s.
Scene moving_clamp(const std::string& way) {
  return parse_scene(
      "name = \"led\"\ngravity = [0, 0, -9.81]\n[rod]\nlength = 0.5\nbending_stiffness = 2e-3\n"
      "mass_per_length = 0.05\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = [1, 0, 0]\n"
      "[[gripper]]\nat = 0.5\ndirection = [1, 0, 0]\n" +
          way,
      "led.toml");
}
Scene in_plane() {
  return moving_clamp(
      "pose = [{time = 0, position = [0.4, 0, 0]}, {time = 1, position = [0.44, 0, 0.1]}]\n");
}
Scene in_space() {
  return moving_clamp(
      "pose = [{time = 0, position = [0.4, 0, 0]}, {time = 1, position = [0.4, 0.1, 0.1]}]\n");
}

constexpr double lag = 0.05;

/// Returns a recording of the rod at rest at `time - late`. Its points are displaced along z, the
/// last marker at the last time by `up` [m], others by less.
MarkerMotion recording(const Scene& scene, double late, double up) {
  MarkerMotion motion{.file = "made.csv", .positions = {}};
  const std::vector<double> s = {0.1, 0.2, 0.3, 0.4};
  for (int k = 0; k <= 10; ++k) {
    const double time = 0.1 * k;
    const Eigen::Matrix3Xd points =
        solve(scene_at(scene, time - late), Model::energy, {}, s).shape.points;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const double share = time * s[i] / 0.4;  // most at the last time, at the last marker
      motion.positions.push_back(
          {time, s[i],
           points.col(static_cast<Eigen::Index>(i)) + Eigen::Vector3d(0, 0, up * share)});
    }
  }
  return motion;
}

MotionCheck checked_motion(const Scene& scene, double late, double up) {
  return check_motion(scene, recording(scene, late, up), {.explaining = Explaining::no});
}

const PlottedCurve* curve_with(const Panel& panel, const std::string& words) {
  const auto found = std::ranges::find_if(panel.curves, [&](const PlottedCurve& curve) {
    return curve.title.find(words) != std::string::npos;
  });
  return found == panel.curves.end() ? nullptr : &*found;
}

const Series& series_of(const Drawing& drawing, const std::string& id) {
  return *std::ranges::find(drawing.series, id, &Series::id);
}

Panel error_panel(const MotionCheck& check) {
  return motion_check_picture(check).rows.at(0).at(1).at(0).panels.at(0);
}

TEST(WorstFrame, HasTheRecordingsPointsOnTheRodOfThatTime) {
  const Scene scene = in_plane();
  constexpr double up = 0.02;
  const MotionCheck check = checked_motion(scene, 0, up);
  EXPECT_EQ(check.worst_frame_error().time, 1.0);
  const Drawing drawing = worst_frame_drawing(check);
  ASSERT_EQ(drawing.views.size(), 1U);
  EXPECT_EQ(drawing.views[0].right, 0);
  EXPECT_EQ(drawing.views[0].up, 2);
  const Eigen::Matrix3Xd& whiskers = series_of(drawing, "whisker").points;
  ASSERT_EQ(whiskers.cols(), 12);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Vector3d distance = whiskers.col(3 * i + 1) - whiskers.col(3 * i);
    EXPECT_LT((distance - Eigen::Vector3d(0, 0, up * 0.25 * static_cast<double>(i + 1))).norm(),
              1e-6);
  }
  EXPECT_LT((series_of(drawing, "worst").points.col(0) - whiskers.col(10)).norm(), 1e-12);
  // The grippers are drawn at their positions at the time of the worst frame.
  EXPECT_LT(
      (series_of(drawing, "rod").points.rightCols<1>() - Eigen::Vector3d(0.44, 0, 0.1)).norm(),
      1e-6);
  EXPECT_TRUE(std::ranges::none_of(
      drawing.series, [](const Series& series) { return series.id == "rod_at_other_time"; }));
}

TEST(WorstFrame, OfALateRecordingIsTheRodOfAnEarlierTime) {
  const MotionCheck check = checked_motion(in_space(), lag, 0);
  ASSERT_NEAR(check.lag, lag, 1e-3);
  const Drawing drawing = worst_frame_drawing(check);
  EXPECT_EQ(drawing.views.size(), 2U);
  const Series& earlier = series_of(drawing, "rod_at_other_time");
  EXPECT_EQ(earlier.title, "the rod 50 ms earlier");
  const FrameShapes& shapes = check.worst_shapes;
  for (Eigen::Index i = 0; i < 4; ++i) {
    // The markers are at multiples of 0.1 m on a rod of 0.5 m; the 201 points of the drawn rod
    // include these.
    EXPECT_LT((earlier.points.col(40 * (i + 1)) - shapes.recorded.points.col(i)).norm(), 1e-4);
  }
}

TEST(MotionPicture, HasTheErrorOfEachFrameAndWhatIsLeftWithoutTheLag) {
  const MotionCheck check = checked_motion(in_plane(), lag, 0);
  const Panel panel = error_panel(check);
  const PlottedCurve* rms = curve_with(panel, "RMS of each frame");
  ASSERT_NE(rms, nullptr);
  ASSERT_EQ(rms->x.size(), check.errors.frames.size());
  for (std::size_t i = 0; i < rms->x.size(); ++i) {
    EXPECT_EQ(rms->x[i], check.errors.frames[i].time);
    EXPECT_EQ(rms->y[i], check.errors.frames[i].rms_m * 1e3);
    EXPECT_LE(rms->y[i], *panel.y.to);
  }
  const PlottedCurve* left = curve_with(panel, "RMS if it were not 50 ms late");
  ASSERT_NE(left, nullptr);
  // With the lag removed, the first recorded frame is earlier than the model's first time and is
  // omitted.
  ASSERT_EQ(left->x.size(), rms->x.size() - 1);
  for (const double distance : left->y) EXPECT_LT(distance, 0.1);
  EXPECT_EQ(curve_with(panel, "the worst frame")->y.front(), *std::ranges::max_element(rms->y));
  EXPECT_EQ(curve_with(error_panel(checked_motion(in_plane(), 0, 0.02)), "if it were not"),
            nullptr);
}

// A rod that hangs straight down and is moved vertically.
TEST(MotionPicture, OfAStraightRodHasFiniteLimits) {
  const Scene scene = parse_scene(
      "name = \"straight\"\ngravity = [0, 0, -9.81]\n[rod]\nlength = 0.5\nbending_stiffness = "
      "0.02\n"
      "mass_per_length = 0.02\n[[gripper]]\nat = 0\ndirection = [0, 0, -1]\n"
      "pose = [{time = 0, position = [0, 0, 0]}, {time = 1, position = [0, 0, 0.1]}]\n",
      "straight.toml");
  const MotionCheck check = checked_motion(scene, 0, 0.01);
  const Picture picture = motion_check_picture(check);
  for (const Panel& drawn : picture.rows.at(0).at(0).at(0).panels) {
    const Panel panel = laid_out(drawn);
    EXPECT_GE(panel.height, 100);
    EXPECT_GT(*panel.x.to, *panel.x.from);
  }
  const std::string script = picture_script(picture, PictureFormat::svg, "a.svg");
  EXPECT_THAT(script, testing::Not(testing::HasSubstr("nan,")));
}

}  // namespace
}  // namespace dlo::compare
