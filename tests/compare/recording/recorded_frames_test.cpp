// Recordings as series and folders of frames, and what is none.

#include "recording/recorded_frames.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "folder_fixture.hpp"
#include "shape/write_vtk.hpp"

namespace dlo::compare {
namespace {

using test::error_of;
using test::says_none;

namespace fs = std::filesystem;

class RecordedFrames : public test::Folder {
 protected:
  /// A line of three points from (0, height, 0), 1 m long.
  void write_frame(const std::string& name, double height, const std::string& title) const {
    Shape shape{{0, 0.25, 1}, Eigen::Matrix3Xd::Zero(3, 3)};
    shape.points.row(0) << 0, 0.25, 1;
    shape.points.row(1).setConstant(height);
    write(name, vtk_polyline(shape, {}, title));
  }
  void expect_refused(const std::string& name, const std::string& words) const {
    const std::string message = error_of<InputError>([&] { return load_recording(path(name), 1); });
    EXPECT_THAT(message, testing::HasSubstr(words));
    EXPECT_THAT(message, testing::HasSubstr("(allowed: "));
    EXPECT_TRUE(says_none(message, {"\n"}));
  }
};

TEST_F(RecordedFrames, OfASeriesHaveItsTimes) {
  write_frame("a.vtk", 0.1, "a");
  write_frame("b.vtk", 0.2, "b");
  write("rod.vtk.series", R"({"file-series-version": "1.0", "files": [
    {"name": "b.vtk", "time": 0.5}, {"name": "a.vtk", "time": 0.25}]})");
  for (const std::string& file : {path("rod.vtk.series"), path("")}) {
    const MarkerMotion motion = load_recording(file, 1);
    ASSERT_EQ(motion.positions.size(), 6U);
    EXPECT_EQ(motion.positions[1].time, 0.25);
    EXPECT_EQ(motion.positions[1].arc_length, 0.25);
    EXPECT_EQ(motion.positions[1].position, Eigen::Vector3d(0.25, 0.1, 0));
    EXPECT_EQ(motion.positions[5].time, 0.5);
  }
}

TEST_F(RecordedFrames, OfAFolderHaveTheTimesOfTheirTitles) {
  write_frame("rod_00001.vtk", 0.2, "cable, t = 0.5 s");
  write_frame("rod_00000.vtk", 0.1, "cable, t = -0.25 s");
  write("notes.txt", "nothing");
  const MarkerMotion motion = load_recording(path(""), 1);
  ASSERT_EQ(motion.positions.size(), 6U);
  EXPECT_EQ(motion.positions[0].time, -0.25);
  EXPECT_EQ(motion.positions[3].position.y(), 0.2);
}

TEST_F(RecordedFrames, WithoutArcLengthsLieAlongTheirPolylines) {
  write("a.vtk",
        "# vtk DataFile Version 3.0\nrod, t = 1 s\nASCII\nDATASET POLYDATA\n"
        "POINTS 3 float\n0 0 0\n0.5 0 0\n2 0 0\n");
  const MarkerMotion motion = load_recording(path(""), 1);
  ASSERT_EQ(motion.positions.size(), 3U);
  EXPECT_NEAR(motion.positions[1].arc_length, 0.25, 1e-12);
  EXPECT_EQ(motion.positions[2].arc_length, 1);
}

TEST_F(RecordedFrames, BadOnesAreToldInOneLine) {
  expect_refused("", "no frames in this folder");
  write_frame("a.vtk", 0.1, "without a time");
  expect_refused("", "a.vtk:2: no time of this frame");
  write("rod.vtk.series", "{\"files\": [{\"name\": \"a.vtk\"}]}");
  expect_refused("rod.vtk.series", "no series of frames");
  write("rod.vtk.series", "not JSON");
  expect_refused("rod.vtk.series", "no series of frames");
  write("rod.vtk.series",
        R"({"files": [{"name": "a.vtk", "time": 1}, {"name": "a.vtk", "time": 1}]})");
  expect_refused("rod.vtk.series", "are both at 1 s");
  write("two.vtk.series", R"({"files": []})");
  expect_refused("", "more than one series");
  expect_refused("two.vtk.series", "no frames");
  write("markers.csv", "time,s,x,y\n0,0,0,0\n");
  expect_refused("markers.csv", "markers.csv:1: not the columns of a recorded motion");
}

}  // namespace
}  // namespace dlo::compare
