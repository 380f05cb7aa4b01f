#include "dlo/compare/shape_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

Eigen::Matrix3Xd expected_points() {
  Eigen::Matrix3Xd points(3, 3);
  points << 0, 0.1, 0.2, 0, -0.01, -0.03, 0, 0, 0.5;
  return points;
}

void expect_points(const std::string& text, bool with_arc_length = false) {
  const MeasuredShape shape = parse_shape(text, "f");
  ASSERT_EQ(shape.points.cols(), 3) << text;
  EXPECT_EQ((shape.points - expected_points()).norm(), 0) << text;
  EXPECT_EQ(shape.arc_length,
            with_arc_length ? (std::vector<double>{0, 0.11, 0.25}) : std::vector<double>())
      << text;
}

TEST(ShapeFile, ReadsCsvWithAndWithoutHeader) {
  expect_points("0,0,0\n0.1,-0.01,0\n0.2,-0.03,0.5\n");
  expect_points("0 0 0\n0.1  -0.01 0\n0.2 -0.03 0.5");
  expect_points("0;0;0\r\n+0.1;-1e-2;0\r\n\r\n0.2;-0.03;0.5\r\n");
  expect_points("# a camera's points\nx,y,z\n0,0,0\n0.1,-0.01,0\n0.2,-0.03,0.5\n");
  expect_points("\xEF\xBB\xBFx,y,z,s\n0,0,0,0\n0.1,-0.01,0,0.11\n0.2,-0.03,0.5,0.25\n", true);
  expect_points(
      "\"S\"\t\"Z\"\t\"Y\"\t\"X\"\n0\t0\t0\t0\n0.11\t0\t-0.01\t0.1\n0.25\t0.5\t-0.03\t0.2", true);
}

TEST(ShapeFile, AMissingZIsZero) {
  EXPECT_EQ(parse_shape("1,2\n3,4\n", "f").points.row(2).norm(), 0);
  EXPECT_EQ(parse_shape("[[1,2],[3,4]]", "f").points(1, 1), 4);
}

TEST(ShapeFile, ReadsJson) {
  expect_points("[[0,0,0],[0.1,-0.01,0],[0.2,-0.03,0.5]]");
  expect_points(
      R"({"schema": "dlo/solve/1", "arc_length_m": [0, 0.11, 0.25], "points_m": [[0,0,0],
         [0.1,-0.01,0],[0.2,-0.03,0.5]]})",
      true);
}

constexpr const char* vtk_head = "# vtk DataFile Version 3.0\na rod\nASCII\nDATASET POLYDATA\n";
constexpr const char* vtk_points = "POINTS 3 float\n0.1 -0.01 0 0 0 0\n0.2 -0.03 0.5\n";

TEST(ShapeFile, ReadsLegacyVtkPolylines) {
  const std::string head = std::string(vtk_head) + vtk_points;
  expect_points(head + "LINES 1 4\n3 1 0 2\nPOINT_DATA 3\nSCALARS a float 1\n");
  expect_points(head + "LINES 2 6\n2 1 0\n2 0 2\n");
  expect_points(head + "LINES 1 4\n3 1 0 2\nPOINT_DATA 3\nFIELD rod 2\na 1 3 double\n1 2 3\n" +
                    "arc_length_m 1 3 double\n0.11 0 0.25\n",
                true);
  expect_points(head +
                "METADATA\nINFORMATION 0\n\nLINES 2 3\nOFFSETS vtktypeint64\n0 3\n"
                "CONNECTIVITY vtktypeint64\n1 0 2\n");
  expect_points(std::string(vtk_head) + "POINTS 3 double\n0 0 0\n0.1 -0.01 0\n0.2 -0.03 0.5\n");
}

TEST(ShapeFile, NumbersAreInTheGivenUnit) {
  const MeasuredShape shape = parse_shape("x,y,s\n0,0,0\n100,-10,101\n", "f", 1e-3);
  EXPECT_DOUBLE_EQ(shape.points(0, 1), 0.1);
  EXPECT_DOUBLE_EQ(shape.arc_length[1], 0.101);
  EXPECT_DOUBLE_EQ(parse_shape(R"({"points": [[0,0],[7,0]]})", "f", 0.01).points(0, 1), 0.07);
}

TEST(ShapeFile, ANumberOfTheNodeIsNoPoint) {
  for (const std::string name : {"node", "id", "Index", "point"}) {
    const MeasuredShape shape = parse_shape(name + ",x,y,z\n7,0,0,0\n3,0.1,-0.2,0.5\n", "f", 1);
    EXPECT_EQ(shape.points.col(1), Eigen::Vector3d(0.1, -0.2, 0.5)) << name;
    EXPECT_TRUE(shape.arc_length.empty()) << name;
  }
  EXPECT_EQ(parse_shape("x;id;y\n0;a7;0\n0.1;a8;-0.2\n", "f", 1).points(1, 1), -0.2);
}

struct Malformed {
  std::string text;
  std::vector<std::string> message;  ///< pieces of it
};

void expect_refused(const std::vector<Malformed>& cases, double unit = 1) {
  for (const Malformed& bad : cases) {
    const std::string message =
        error_of<InputError>([&] { return parse_shape(bad.text, "mine", unit); });
    EXPECT_TRUE(has_none(message, {"\n"}));
    EXPECT_TRUE(has_all(message, bad.message));
  }
}

TEST(ShapeFile, RefusesMalformedCsvWithFileAndLine) {
  expect_refused({
      {"", {"mine: empty", "allowed"}},
      {" \n\n", {"mine: empty"}},
      {"# only a comment\n", {"mine: 0 points", "2 to 100000"}},
      {"x,y,z\n", {"mine: 0 points"}},
      {"1,2,3\n", {"mine: 1 point ", "allowed: 2"}},
      {"x,y,z\n0,0,0\n1,0,nan\n", {"mine:3: point 2: z = nan", "allowed"}},
      {"0,0\n1,inf\n", {"mine:2: point 2: y = inf"}},
      {"0,0\n1,1e999\n", {"mine:2: point 2: y = inf"}},
      {"0,0\n1,1e7\n", {"mine:2: point 2: y = 1e+07", "1e+06 m"}},
      {"0,0\n1,2,3\n", {"mine:2: 3 columns", "allowed: 2"}},
      {"x,y,z\n1,2\n", {"mine:2: 2 columns", "allowed: 3"}},
      {"7\n8\n", {"mine:1: 1 column ", "x,y,z"}},
      {"1,2,3,4,5\n", {"mine:1: 5 columns"}},
      {"x,y,time\n1,2,3\n", {"mine:1: unknown column \"time\"", "allowed: x,y"}},
      {"node,x,y,z\n1,2,3\n", {"mine:2: 3 columns", "allowed: 4"}},
      {"x,z\n1,2\n", {"mine:1: column y is missing"}},
      {"x,y,x\n1,2,3\n", {"mine:1: column x given twice"}},
      {"0,0\n0.5,abc\n", {"mine:2: y = \"abc\" is not a number"}},
      {"0,0\n0.5,1 mm\n", {"mine:2: y = \"1 mm\" is not a number"}},
      {"0,0\n0.5,\n", {"mine:2: y = \"\" is not a number"}},
      {"0,0\n1,1\n1,1\n2,2\n", {"mine:3: point 3: the same as the point before"}},
      {"0,0\n1e-200,0\n2e-200,0\n", {"mine:2: point 2: the same as the point before"}},
      {"x,y,s\n0,0,0\n1,0,1\n2,0,0.5\n", {"mine:4: point 3: s = 0.5 after 1", "allowed"}},
      {"x,y,s\n0,0,1\n1,0,1\n", {"mine:3: point 2: s = 1 after 1"}},
      {std::string("\x01\x02\x00\xFF", 4), {"mine:1"}},
  });
}

TEST(ShapeFile, RefusesMalformedJsonWithTheElement) {
  expect_refused({
      {"[[0,0],\n[1,", {"mine:2: not valid JSON"}},
      {"[[0,0],[1,1e999]]", {"mine", "out of range"}},
      {"[]", {"mine: 0 points"}},
      {"{}", {"neither points_m nor points", "allowed"}},
      {"[1,2,3]", {"mine: points[0]: must be a point"}},
      {"[[0,0],[1,2,3]]", {"points[1]: 3 coordinates where the first point has 2"}},
      {"[[0,0],[1,null]]", {"points[1][1]: must be a number"}},
      {"[[0,0],[1,\"2\"]]", {"points[1][1]: must be a number"}},
      {"[[0,0,0,0]]", {"points[0]: must be a point"}},
      {R"({"points_m": 3})", {"points_m: must be an array"}},
      {R"({"points_m": [[0,0],[1,1]], "points": []})", {"one of them"}},
      {R"({"points_m": [[0,0],[1,1]], "arc_length_m": [0]})", {"arc_length_m", "2 numbers"}},
      {R"({"points_m": [[0,0],[1,1]], "arc_length_m": [0, "1"]})", {"arc_length_m[1]"}},
      {R"({"points_m": [[0,0],[0,0]]})", {"point 2: the same as"}},
  });
  expect_refused({{R"({"points_m": [[0,0],[1,1]]})", {"points_m is in metres", "allowed"}}}, 1e-3);
}

TEST(ShapeFile, RefusesMalformedVtkWithFileAndLine) {
  const std::string head = vtk_head;
  const std::string points = head + vtk_points;
  expect_refused({
      {"<VTKFile type=\"PolyData\">", {"mine: XML such as VTU or VTP", "read_nodes.md"}},
      {points + "POINT_DATA 3\nFIELD f 1\narc_length_m 1 2 double\n0 1\n", {"mine:10", "3 values"}},
      {points + "POINT_DATA 3\nFIELD f 1\narc_length_m 1 3 double\n0 1 b\n", {"mine:11", "\"b\""}},
      {points + "POINT_DATA 3\nFIELD f 1\narc_length_m 1 3 double\n0 1 1\n", {"s = 1 after 1"}},
      {"# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\n", {"mine:3: BINARY", "ASCII"}},
      {"# vtk DataFile Version 3.0\nt\n", {"mine:3: \"\"", "ASCII"}},
      {"# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n",
       {"mine:4", "STRUCTURED_GRID", "allowed: POLYDATA"}},
      {head, {"no POINTS"}},
      {head + "POINTS 99999999999999999999 float\n", {"mine:5: number of points", "100000"}},
      {head + "POINTS 3000000 float\n", {"mine:5", "allowed: 0 to 100000"}},
      {head + "POINTS -3 float\n", {"mine:5: number of points \"-3\""}},
      {head + "POINTS 3 float\n0 0 0\n1 0", {"mine:7: the file ends in point 2 of 3"}},
      {head + "POINTS 2 float\n0 0 0\n1 0 x\n", {"mine:7: point 2: \"x\" is not a number"}},
      {head + "POINTS 2 float\n0 0 0\n1 0 0\n5 6 7\n", {"mine:8: \"5\" in place of a keyword"}},
      {head + "POINTS 2 float\n0 0 0\n1 0 nan\n", {"mine:7: point 2: z = nan"}},
      {head + "LINES 1 3\n2 0 1\n", {"LINES before POINTS"}},
      {points + "LINES 1 4\n3 0 1 3\n", {"mine:9: LINES: index \"3\"", "0 to 2"}},
      {points + "LINES 1 4\n3 0 1\n", {"LINES: index \"\""}},
      {points + "LINES 1 1\n1 0\n", {"fewer than two points"}},
      {points + "LINES 2 6\n2 0 1\n2 2 0\n", {"mine:10: several separate lines"}},
      {points + "LINES 1 4\n3 0 0 1\n", {"point 2: the same as"}},
      {points + "POLYGONS 1 4\n3 0 1 2\n", {"POLYGONS", "allowed: POINTS and LINES"}},
      {points + "LINES 2 3\nOFFSETS vtktypeint64\n3 0\n", {"must not fall"}},
      {points + "LINES 2 3\nOFFSETS vtktypeint64\n0 4\n", {"OFFSETS: offset \"4\""}},
  });
}

TEST(ShapeFile, RefusesMorePointsThanAllowed) {
  std::string text;
  for (long i = 0; i <= most_shape_points; ++i) text += std::to_string(i) + ",0\n";
  expect_refused({{text, {"mine:100001: 100001 points", "2 to 100000"}}});
}

}  // namespace
}  // namespace dlo::compare
