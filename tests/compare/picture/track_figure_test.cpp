#include "picture/track_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

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

using Rows = std::vector<std::vector<std::string>>;

/// Of a CSV file, without its header.
Rows rows_of(const std::string& csv) {
  Rows rows;
  std::istringstream stream(csv.substr(csv.find('\n') + 1));
  for (std::string line; std::getline(stream, line);) {
    if (line.empty()) continue;
    std::istringstream fields(line);
    std::vector<std::string>& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
  }
  return rows;
}

/// Two numbers between a word of a script and the end of its line, such as a range.
std::array<double, 2> numbers_after(const std::string& script, const std::string& word) {
  std::istringstream line(script.substr(script.find(word) + word.size()));
  std::array<double, 2> numbers{};
  char between = 0;
  line >> numbers[0] >> between >> numbers[1];
  return numbers;
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
  EXPECT_THAT(strip.panels.front().script, testing::HasSubstr("'t = 1 s'"));
}

// A wall goes on without end, and the cells beside it are not its place.
TEST(TrackFigures, NothingOfAStripLeavesItsCell) {
  const Motion motion(buckling_wire, 20);
  const Figure strip = motion.figures().strip;
  const Panel& panel = strip.panels.front();
  const std::array<double, 2> right = numbers_after(panel.script, "set xrange [");
  const std::array<double, 2> up = numbers_after(panel.script, "set yrange [");
  const double wide = numbers_after(panel.script, "set xtics ")[1];
  const double high = numbers_after(panel.script, "set ytics ")[1];
  EXPECT_NEAR(plot_width / right[1], panel.height / up[1], 0.01 * plot_width / right[1]);
  std::map<std::string, std::array<double, 2>> shifts;
  std::istringstream script(panel.script);
  for (std::string line; std::getline(script, line);) {
    const std::size_t name = line.find("eq '");
    if (name == std::string::npos) continue;
    const std::string id = line.substr(name + 4, line.find('\'', name + 4) - name - 4);
    shifts[id] = {std::stod(line.substr(line.find("? $3") + 4)),
                  std::stod(line.substr(line.find("($4") + 3))};
  }
  int obstacles = 0;
  for (const auto& row : rows_of(strip.csv)) {
    const std::string& id = row.front();
    ASSERT_EQ(shifts.count(id), 1U) << id;
    if (id.rfind("clamp", 0) == 0 || id.rfind("gripper", 0) == 0) continue;
    if (id.rfind("obstacle", 0) == 0) ++obstacles;
    const int cell = std::stoi(id.substr(id.rfind('_') + 1)) - 1;
    const int columns = static_cast<int>(std::lround(right[1] / wide));
    const int rows = static_cast<int>(std::lround(up[1] / high));
    const double x = std::stod(row[2]) + shifts[id][0] - wide * (cell % columns);
    const int above = rows - 1 - cell / columns;
    const double y = std::stod(row[3]) + shifts[id][1] - high * above;
    const double round = 1e-4 * wide;
    EXPECT_GE(x, -round) << id;
    EXPECT_LE(x, wide + round) << id;
    EXPECT_GE(y, -round) << id;
    EXPECT_LE(y, high + round) << id;
  }
  EXPECT_GT(obstacles, 0);
}

// Every gripper's curve is in one piece, and the upright lines are at the times of the events.
TEST(TrackFigures, ForcesAreThoseOfTheFrames) {
  const Motion motion(corner_routing, 50);
  const Figure forces = motion.figures().forces;
  const Rows rows = rows_of(forces.csv);
  const std::size_t frames = motion.followed.frames.size();
  ASSERT_EQ(rows.size(), 2 * frames);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const GripperLoad& load = motion.followed.frames[i % frames].grippers[i / frames];
    EXPECT_EQ(rows[i][2], std::to_string(i / frames + 1));
    EXPECT_NEAR(std::stod(rows[i][3]), load.force.norm(), 1e-9 * load.force.norm());
    EXPECT_NEAR(std::stod(rows[i][4]), load.torque.norm(), 1e-9 * load.torque.norm());
  }
  ASSERT_FALSE(motion.followed.events.empty());
  std::size_t lines = 0;
  const std::string& script = forces.panels.front().script;
  for (std::size_t at = script.find("set arrow"); at != std::string::npos;
       at = script.find("set arrow", at + 1)) {
    const double time = std::stod(script.substr(at + 15));
    const TrackEvent& event = motion.followed.events.at(lines);
    EXPECT_NEAR(time, motion.followed.frames[event.frame].time, 1e-7);
    ++lines;
  }
  EXPECT_EQ(lines, motion.followed.events.size());
}

}  // namespace
}  // namespace dlo::compare
