#include <gtest/gtest.h>

#include <string>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

TEST(ReadMarkers, TakesRowsAndColumnsInAnyOrder) {
  const MarkerMotion read = parse_markers(
      "# by a camera\nx,y,z,s,time\n1,2,3,0.5,0.1\n\n4,5,6,0.2,0.1\r\n7,8,9,0.5,0\n", "m.csv");
  ASSERT_EQ(read.positions.size(), 3U);
  EXPECT_EQ(read.positions[0].position, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(read.positions[1].arc_length, 0.2);
  EXPECT_EQ(read.positions[2].time, 0.1);
}

TEST(ReadMarkers, SaysWhatIsWrongAndWhere) {
  const auto expect_refused = [](const std::string& text, const std::string& why) {
    EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_markers(text, "m.csv"); }), {why}));
  };
  expect_refused("time,x,y,z\n0,1,2,3\n", "m.csv:1: column s is missing");
  expect_refused("time,s,x,y,z\n", "m.csv: no rows");
  expect_refused("time,s,x,y,z\n0,1,2,3\n", "m.csv:2: ");
  expect_refused("time,s,x,y,z\n0,1,2,3,nan\n", "m.csv:2: z = \"nan\" is not a number");
  expect_refused("time,s,x,y,z\n0,1,2,3,4\n0,2,1e200,3,4\n", "m.csv:3: x = 1e+200: out of range");
  expect_refused("time,s,x,y,z\n-1e13,1,2,3,4\n", "m.csv:2: time = -1e+13: out of range");
  expect_refused("time,s,x,y,z\n0,1,2,3,4\n0,1,2,3,5\n", "twice at time = 0 s");
}

}  // namespace
}  // namespace dlo::compare
