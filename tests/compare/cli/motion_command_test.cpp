// Tests of the commands for recorded motions: `check --motion` and `calibrate --motion`.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::StartsWith;

class MotionCommand : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    write("swung.toml", swung(0.02));
  }
  static std::string swung(double stiffness) {
    return fmt::format(
        "[rod]\nlength = 0.4\nbending_stiffness = {}\nmass_per_length = 0.05\n[[gripper]]\nat = 0\n"
        "direction = \"-60 deg\"\npose = [{{time = 0, position = [0, 0, 0]}}, {{time = 0.3, "
        "position = [0.1, 0.02, 0]}}]\n",
        stiffness);
  }
  /// Writes 40 times per second the positions of markers at a quarter, half, three quarters and the
  /// end of the rod with inertia. Their times are increased by `late` [s].
  void write_markers(const std::string& name, double late = 0) const {
    const json document = json_of(words({"track", path("swung.toml"),
                                         "--no-force --dynamic --damping 0.01 --frame-rate 40 "
                                         "--samples 5 --shapes"}));
    const auto s = document.at("arc_length_m").get<std::vector<double>>();
    std::vector<std::vector<double>> rows;
    for (const json& frame : document.at("dynamic").at("frames")) {
      const double time = frame.at("time_s").get<double>() + late;
      for (std::size_t i = 1; i < 5; ++i) {
        const auto point = frame.at("points_m").at(i).get<std::vector<double>>();
        rows.push_back({time, s[i], point[0], point[1], point[2]});
      }
    }
    (void)write_table(name, "time,s,x,y,z", rows);
  }
  [[nodiscard]] std::string check(const std::string& more) const {
    return words({"check", path("swung.toml"), "--motion", more});
  }
};

TEST_F(MotionCommand, CheckJudgesMarkersByTheRodThatIsAsked) {
  write_markers("markers.csv");
  const std::string tolerance = path("markers.csv") + " --tolerance 0.1%";
  expect_output(check(tolerance + " --dynamic --damping 0.01"), 0, {"pass: RMS", " with_inertia"});
  expect_output(check(tolerance + " --damping 0.01"), 1,
                {"the rod has inertia (--dynamic)", "fail: RMS"});
  // Without a tolerance the command succeeds, but the report shows the verdict "fail".
  const std::string markers = path("markers.csv");
  succeeds(check(markers + " --report " + path("page.html")));
  EXPECT_THAT(read(path("page.html")), HasSubstr("<p class=\"badge fail\">"));
  expect_error(check(markers + " --report " + markers), 2, {"markers.csv"});
}

// With three terms no equilibrium of such a soft rod is resolved.
TEST_F(MotionCommand, CheckOfARodWithInertiaNeedsNoEquilibria) {
  write_markers("markers.csv");
  write("swung.toml", swung(1e-4));
  const std::string few = path("markers.csv") + " --terms 3 --no-explanation";
  expect_error(check(few), 3, {"did not converge"});
  EXPECT_EQ(json_of(check(few + " --dynamic --damping 0.01")).at("at_rest_rms_m"), nullptr);
}

TEST_F(MotionCommand, CheckTellsLagAndFrames) {
  write_markers("late.csv", 0.02);
  const std::string late = path("late.csv") + " --dynamic --damping 0.01 --from 0";
  const json document = json_of(check(late));
  EXPECT_EQ(document.at("schema"), "dlo/motion_check/1");
  EXPECT_EQ(document.at("model"), "with_inertia");
  EXPECT_NEAR(document.at("lag_s"), 0.02, 1e-4);
  EXPECT_LT(document.at("rms_without_lag_m").get<double>(), 1e-5);
  EXPECT_EQ(document.at("frames").size(), 13U);
  EXPECT_EQ(document.at("causes").at(0).at("kind"), "lag");
  EXPECT_EQ(document.at("no_inertia"), nullptr);
  const std::string csv = run(check(late + " --format csv")).out;
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "time_s,rms_m,largest_m,largest_at_m");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 14);
  for (const json& frame : document.at("frames")) {
    EXPECT_LE(frame.at("rms_m").get<double>(), document.at("worst").at("rms_m").get<double>());
  }
}

TEST_F(MotionCommand, CheckRefusesBadRecordingsInOneLine) {
  write_markers("markers.csv");
  expect_error(check(path("none.csv")), 2, {"none.csv"});
  expect_error(words({"check", path("swung.toml")}), 2, {"--shape FILE, --motion FILE"});
  write("table.csv", "time_s,energy_J\n0,1\n");
  expect_error(check(path("table.csv")), 2, {"table.csv:1", "allowed: a header of time,s,x,y,z"});
  write("rod.npz", std::string("PK\x03\x04") + "a zip archive");
  expect_error(check(path("rod.npz")), 2, {"rod.npz", "doc/howto/read_nodes.md"});
  write("far.csv", "time,s,x,y,z\n0,0.1,0,0,0\n1,0.5,0,0,0\n");
  expect_error(check(path("far.csv")), 2, {"s = 0.5 m", "allowed: 0 to the rod's 0.4 m"});
  write("once.csv", "time,s,x,y,z\n0,0.1,0,0,0\n");
  expect_error(check(path("once.csv")), 2, {"once.csv", "one time only"});
  expect_error(check(path("markers.csv") + " --from 0.2"), 2, {"--from", "allowed"});
  expect_error(words({"check", steel(), "--motion", path("markers.csv")}), 2, {"nothing moves"});
  expect_error(check(path("markers.csv") + " --shape x.csv"), 2, {"--motion", "--shape"});
}

TEST_F(MotionCommand, MeasuredPosesAreSmoothedBelowTheirCutoff) {
  // The path is a line with an error of +-1 mm that alternates from row to row, at half the
  // sampling rate.
  std::string rows = "time,x,y,z\n";
  for (int k = 0; k <= 200; ++k) {
    rows += fmt::format("{},{},0,0\n", 0.01 * k, 1e-3 * k + (k % 2 == 0 ? 1e-3 : -1e-3));
  }
  write("way.csv", rows);
  const std::string rod =
      "[rod]\nlength = 0.4\nbending_stiffness = 0.02\nmass_per_length = 0.05\n[[gripper]]\nat = 0\n"
      "direction = 0\n";
  const std::string way = "trajectory = \"way.csv\"\n";
  write("smooth.toml", rod + way + "cutoff = \"5 Hz\"\n");
  const json document = json_of(
      words({"track", path("smooth.toml"), "--no-force --from 0.5 --to 1.5 --frame-rate 37"}));
  for (const json& frame : document.at("frames")) {
    // The filter reduces the alternating error of the rows by the gain 1 / (1 + (sqrt(2) - 1) /
    // sin(pi / 20)^4), about 0.0014.
    EXPECT_NEAR(frame.at("grippers").at(0).at("position_m").at(0),
                0.1 * frame.at("time_s").get<double>(), 2e-6);
  }
  write("fast.toml", rod + way + "cutoff = \"50 Hz\"\n");
  expect_error(words({"solve", path("fast.toml")}), 2, {"gripper.cutoff = '50 Hz'", "50 Hz)"});
  write("alone.toml", rod + "position = [0, 0, 0]\ncutoff = \"5 Hz\"\n");
  expect_error(words({"solve", path("alone.toml")}), 2, {"gripper.trajectory", "beside cutoff"});
}

TEST_F(MotionCommand, CalibrateFindsTheStiffnessThatMovedTheMarkers) {
  write_markers("markers.csv");
  write("softer.toml", swung(0.015));
  const std::string calibrate =
      words({"calibrate", path("softer.toml"), "--motion", path("markers.csv")});
  const json document = json_of(calibrate);
  EXPECT_EQ(document.at("schema"), "dlo/motion_fit/1");
  EXPECT_NEAR(document.at("stiffness").at("value"), 0.02, 1e-4);
  EXPECT_NEAR(document.at("damping_s").at("value"), 0.01, 1e-3);
  // The simulation of the markers had no drag of either kind.
  for (const char* none : {"drag_N_s_per_m2", "quadratic_drag_N_s2_per_m3"}) {
    EXPECT_EQ(document.at(none).at("value"), nullptr) << none;
    EXPECT_EQ(document.at(none).at("low"), 0) << none;
    EXPECT_LT(document.at(none).at("high"), 0.01) << none;
  }
  expect_error(calibrate + "--format csv", 2, {"--format csv: not available with --motion"});
  expect_error(calibrate + "--time-limit 0.001", 3, {"markers.csv", "time limit"});
}

TEST_F(MotionCommand, WhatCalibrateWritesMakesTheMotionRight) {
  write_markers("markers.csv");
  write("softer.toml", swung(0.015));
  const std::string found = path("found.toml");
  succeeds(words({"calibrate", path("softer.toml"), "--motion", path("markers.csv"), "-o", found}));
  EXPECT_TRUE(has_all(read(found), {"bending_stiffness = 2.0", "\nmass_per_length = 5.0",
                                    "\ndamping = ", "# s, 95 %: ", "1 recorded motion,"}));
  const std::string as_found = " --dynamic --calibrated " + found;
  succeeds(words({"check", path("softer.toml"), "--motion", path("markers.csv"),
                  "--tolerance 0.01%" + as_found}));
  const std::string track = words({"track", path("softer.toml"), "--no-force --frame-rate 40"});
  EXPECT_NEAR(json_of(track + as_found).at("dynamic").at("damping_s"), 0.01, 1e-3);
  // An option overrides the value from the file.
  EXPECT_EQ(json_of(track + as_found + " --damping 0.2").at("dynamic").at("damping_s"), 0.2);
}

// The only marker is at the clamp, where the motion does not depend on the stiffness.
TEST_F(MotionCommand, CalibrateReportsAStiffnessThatIsNotIdentifiedWithExitStatusThree) {
  write("clamped.csv",
        "time,s,x,y,z\n0.02,0,0.0013,0.0003,0\n0.1,0,0.02593,0.00519,0\n0.2,0,0.0741,0.0148,0\n");
  const std::string calibrate =
      words({"calibrate", path("swung.toml"), "--motion", path("clamped.csv")});
  expect_output(calibrate, 3, {"not identified"});
  expect_output(calibrate + "-o " + path("found.toml"), 3,
                {"nothing is written, EI is not identified: "});
  const json document = json::parse(run(calibrate + " --format json").out);
  EXPECT_FALSE(document.at("identified").get<bool>());
  EXPECT_EQ(document.at("damping_s").at("value"), nullptr);
}

TEST_F(MotionCommand, ARecordingIsAStartForTrack) {
  write_markers("markers.csv");
  const std::string released = swung(0.02) + "[track]\nstart = \"start.csv\"\n";
  // The start is the recording from time 0.1 s on, and so the track begins at 0.1 s.
  std::string later = "time,s,x,y,z\n";
  std::istringstream rows(read(path("markers.csv")));
  std::string row;
  while (std::getline(rows, row)) {
    if (row[0] != 't' && std::stod(row) >= 0.1) later += row + "\n";
  }
  write("start.csv", later);
  write("released.toml", released);
  const json followed = json_of(words(
      {"track", path("released.toml"), "--no-force --dynamic --damping 0.01 --frame-rate 40"}));
  EXPECT_EQ(followed.at("dynamic").at("frames").at(0).at("time_s"), 0.1);
  write("start.csv", "time,s,x,y,z\n0,0.5,0,0,0\n");
  expect_error(words({"track", path("released.toml"), "--dynamic"}), 2,
               {"track.start", "s = 0.5 m", "allowed: 0 to the rod's 0.4 m"});
  write("released.toml", swung(0.02) + "[track]\nstart = \"none.csv\"\n");
  expect_error(words({"track", path("released.toml"), "--dynamic"}), 2,
               {"track.start", "no such file beside the scene"});
}

// The rows of the first file are after the end of the scene's motion. Those of the second are
// closer in time than two times that are distinguished.
TEST_F(MotionCommand, CalibrateRefusesRowsInWhichTheRodDoesNotMove) {
  const std::string header = "time,s,x,y,z\n";
  write("after.csv", header + "50,0.3,0,-0.3,0\n50.1,0.3,0,-0.3,0\n50.2,0.3,0,-0.3,0\n");
  write("short.csv", header + "0,0.2,0.1,-0.17,0\n0,0.4,0.2,-0.3,0\n3e-13,0.2,0.1,-0.17,0\n");
  const auto refused = [&](const std::string& file, const std::string& time) {
    expect_error(words({"calibrate", path("swung.toml"), "--motion", path(file)}), 2,
                 {file + ": the rod does not move", "all 3 rows", time, "from 0 to 0.3 s"});
  };
  refused("after.csv", "time = 50 to 50.2 s");
  refused("short.csv", "time = 0 to 3e-13 s");
}

}  // namespace
}  // namespace dlo::compare
