#include "picture/track_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "csv_table.hpp"
#include "report/report.hpp"

namespace dlo::compare {
namespace {

/// One of the moving scenes that the command has built in, with few frames.
struct Motion {
  explicit Motion(std::size_t file, double frame_rate) : scene(report_moving_files()[file].scene) {
    options.rates = scene.track;
    options.rates.frames = frame_rate;
    followed = track(scene, options);
  }
  [[nodiscard]] TrackFigures figures() const {
    return track_figures(scene, {followed}, options, 1);
  }

  Scene scene;
  TrackOptions options;
  Track followed;
};

constexpr std::size_t corner_routing = 0;
constexpr std::size_t buckling_wire = 1;

/// Of a CSV file, without its header.
std::vector<test::CsvRow> rows_of(const std::string& csv) {
  return test::csv_rows(csv.substr(csv.find('\n') + 1));
}

TEST(TrackFigures, StripHasTheShapesOfItsFrames) {
  const Motion motion(corner_routing, 20);
  const Figure strip = motion.figures().strip;
  std::map<std::string, int> counts;
  for (const auto& row : rows_of(strip.csv)) ++counts[row.front()];
  const int samples = static_cast<int>(motion.followed.arc_length.size());
  for (int i = 1; i <= 9; ++i) EXPECT_EQ(counts["energy_" + std::to_string(i)], samples) << i;
  EXPECT_EQ(counts.count("energy_10"), 0U);
  // 41 frames: the fifth of nine is the one in the middle.
  const TrackFrame& middle = motion.followed.frames.at(20);
  Eigen::Index point = 0;
  for (const auto& row : rows_of(strip.csv)) {
    if (row.front() != "energy_5") continue;
    EXPECT_NEAR(std::stod(row[2]), middle.shape.points(0, point), 1e-9);
    EXPECT_NEAR(std::stod(row[3]), middle.shape.points(1, point), 1e-9);
    ++point;
  }
  EXPECT_EQ(strip.panels.front().texts.at(4).words, "t = 1 s");
}

// A wall goes on without end, and the cells beside it are not its place.
TEST(TrackFigures, NothingOfAStripLeavesItsCell) {
  const Motion motion(buckling_wire, 20);
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
    for (const double x : curve.x) {
      EXPECT_GE(x, left - round) << id;
      EXPECT_LE(x, left + wide + round) << id;
    }
    for (const double y : curve.y) {
      EXPECT_GE(y, below - round) << id;
      EXPECT_LE(y, below + high + round) << id;
    }
  }
  EXPECT_GT(obstacles, 0);
}

// Every gripper's curve is in one piece, and the upright lines are at the times of the events.
TEST(TrackFigures, ForcesAreThoseOfTheFrames) {
  const Motion motion(corner_routing, 50);
  const Figure forces = motion.figures().forces;
  const std::vector<test::CsvRow> rows = rows_of(forces.csv);
  const std::size_t frames = motion.followed.frames.size();
  ASSERT_EQ(rows.size(), 2 * frames);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const GripperLoad& load = motion.followed.frames[i % frames].grippers[i / frames];
    EXPECT_EQ(rows[i][2], std::to_string(i / frames + 1));
    EXPECT_NEAR(std::stod(rows[i][3]), load.force.norm(), 1e-9 * load.force.norm());
    EXPECT_NEAR(std::stod(rows[i][4]), load.torque.norm(), 1e-9 * load.torque.norm());
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
