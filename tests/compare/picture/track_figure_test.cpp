#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "dlo/compare/scene_file.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

/// Moving scene of data/scenes with its track at a given frame rate.
struct Motion {
  explicit Motion(const std::string& name, double frame_rate)
      : scene(load_scene(DLO_DATA "/scenes/" + name + ".toml")) {
    options.rates = scene.track;
    options.rates.frame_rate = frame_rate;
    followed = track(scene, options);
  }
  [[nodiscard]] TrackFigures figures() const { return track_figures(scene, {followed}, options); }

  Scene scene;
  TrackOptions options;
  Track followed;
};

TEST(TrackFigures, StripHasTheShapesOfItsFrames) {
  const Motion motion("corner_routing", 20);
  const Figure strip = motion.figures().strip;
  const Panel& panel = strip.panels.front();
  std::map<std::string, const PlottedCurve*> curves;
  for (const PlottedCurve& curve : panel.curves) curves[curve.id] = &curve;
  const std::size_t samples = motion.followed.arc_length.size();
  for (int i = 1; i <= 9; ++i) {
    ASSERT_TRUE(curves.contains("energy_" + std::to_string(i))) << i;
    EXPECT_EQ(curves.at("energy_" + std::to_string(i))->x.size(), samples) << i;
  }
  EXPECT_FALSE(curves.contains("energy_10"));
  // There are 41 frames, so the fifth of nine cells shows the middle frame; its drawing is only
  // translated.
  const TrackFrame& middle = motion.followed.frames.at(20);
  const PlottedCurve& drawn = *curves.at("energy_5");
  for (std::size_t k = 1; k < samples; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(drawn.x[k] - drawn.x[0], middle.shape.points(0, at) - middle.shape.points(0, 0),
                1e-9);
    EXPECT_NEAR(drawn.y[k] - drawn.y[0], middle.shape.points(1, at) - middle.shape.points(1, 0),
                1e-9);
  }
  EXPECT_EQ(strip.panels.front().texts.at(4).words, "t = 1 s");
}

// A wall is infinite, but must not be drawn in the adjacent cells.
TEST(TrackFigures, NothingOfAStripLeavesItsCell) {
  const Motion motion("buckling_wire", 20);
  const Figure strip = motion.figures().strip;
  const Panel& panel = strip.panels.front();
  const double right = panel.x.to.value();
  const double up = panel.y.to.value();
  const double wide = panel.x.tics->at(1).at;
  const double high = panel.y.tics->at(1).at;
  EXPECT_NEAR(plot_width / right, panel.height / up, 0.01 * plot_width / right);
  const int columns = static_cast<int>(std::lround(right / wide));
  const int rows = static_cast<int>(std::lround(up / high));
  int obstacles = 0;
  for (const PlottedCurve& curve : panel.curves) {
    const std::string& id = curve.id;
    if (id.rfind("clamp", 0) == 0 || id.rfind("gripper", 0) == 0) continue;
    if (id.rfind("obstacle", 0) == 0) ++obstacles;
    const int cell = std::stoi(id.substr(id.rfind('_') + 1)) - 1;
    const double left = wide * (cell % columns);
    const double below = high * (rows - 1 - cell / columns);
    const double round = 1e-4 * wide;
    EXPECT_GE(std::ranges::min(curve.x), left - round) << id;
    EXPECT_LE(std::ranges::max(curve.x), left + wide + round) << id;
    EXPECT_GE(std::ranges::min(curve.y), below - round) << id;
    EXPECT_LE(std::ranges::max(curve.y), below + high + round) << id;
  }
  EXPECT_GT(obstacles, 0);
}

// Every gripper's curve is in one piece, and the upright lines are at the times of the events.
TEST(TrackFigures, ForcesAreThoseOfTheFrames) {
  const Motion motion("corner_routing", 50);
  const Figure forces = motion.figures().forces;
  for (const std::size_t gripper : {0U, 1U}) {
    const PlottedCurve& force = forces.panels.at(0).curves.at(gripper);
    const PlottedCurve& torque = forces.panels.at(1).curves.at(gripper);
    ASSERT_EQ(force.y.size(), motion.followed.frames.size());
    for (std::size_t i = 0; i < force.y.size(); ++i) {
      const GripperLoad& load = motion.followed.frames[i].grippers[gripper];
      EXPECT_EQ(force.y[i], load.force.norm());
      EXPECT_EQ(torque.y[i], load.torque.norm());
    }
  }
  ASSERT_FALSE(motion.followed.events.empty());
  std::multiset<double> drawn;
  for (const PlottedCurve& curve : forces.panels.front().curves) {
    for (std::size_t i = 0; i < curve.y.size(); ++i) {
      if (curve.y[i] == HUGE_VAL) drawn.insert(curve.x[i]);
    }
  }
  std::multiset<double> times;
  for (const TrackEvent& event : motion.followed.events) {
    times.insert(motion.followed.frames[event.frame].time);
  }
  EXPECT_EQ(drawn, times);
}

}  // namespace
}  // namespace dlo::compare
