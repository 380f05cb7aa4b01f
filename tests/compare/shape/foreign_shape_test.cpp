// Tests of shape files of other programs. NumPy wrote the arrays of tests/fuzz/corpus/shape.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

const std::string corpus = DLO_FUZZ_CORPUS "/shape/";

void expect_file_points(const std::string& name, double rounding = 0, double unit = 1) {
  Eigen::Matrix3Xd expected(3, 3);
  expected << 0, 0.1, 0.2, 0, -0.01, -0.03, 0, 0, 0.5;
  const MeasuredShape shape = load_shape(corpus + name, unit);
  ASSERT_EQ(shape.points.cols(), 3) << name;
  EXPECT_LE((shape.points - expected).cwiseAbs().maxCoeff(), rounding) << name;
}

/// Half a unit in the last place of a binary32 number near 0.5.
constexpr double rounding_of_float = 3e-8;

TEST(ForeignShape, ReadsNumPyArraysOfAnyTypeAndOrder) {
  expect_file_points("f8.npy");
  expect_file_points("big_f4_fortran.npy", rounding_of_float);
  const MeasuredShape plane = load_shape(corpus + "two_columns_i2.npy", 1e-3);
  EXPECT_EQ(plane.points.row(2).norm(), 0);
  EXPECT_DOUBLE_EQ(plane.points(0, 2), 0.2);
  EXPECT_DOUBLE_EQ(plane.points(1, 2), -0.03);
}

TEST(ForeignShape, TheNameChoosesAFrame) {
  expect_file_points("frames.npy:1");
  expect_file_points("frames.npy:-1");
}

TEST(ForeignShape, ATableOfNodesNeedsNoHeader) {
  expect_file_points("nodes.csv");
  expect_file_points("nodes_more.csv");
  EXPECT_EQ(load_shape(corpus + "nodes_more.csv").notes.size(), 1U);
  // A fourth column that increases from row to row by 0.99 to 1.5 times the distance of the points
  // is the arc length.
  const std::string whole = "0 0 0 0\n1 0 0 1\n2 1 0 2.5\n";
  EXPECT_EQ(parse_shape(whole, "f", 1e-3).arc_length.size(), 3U);
  EXPECT_TRUE(parse_shape("0 0 0 0\n1 0 0 -1\n2 1 0 2.5\n", "f").arc_length.empty());
  const MeasuredShape named = parse_shape("node,x,y,z,u_x\n1,0,0,0,7\n2,0.1,0,0,7\n", "f");
  EXPECT_EQ(named.points(0, 1), 0.1);
  ASSERT_EQ(named.notes.size(), 1U);
  EXPECT_TRUE(has_all(named.notes[0], {"u_x"}));
}

void expect_file_refused(const std::string& name, const std::vector<std::string>& pieces) {
  const std::string message = error_of<InputError>([&] { return load_shape(corpus + name); });
  EXPECT_TRUE(has_none(message, {"\n"}));
  EXPECT_TRUE(has_all(message, pieces));
}

TEST(ForeignShape, SeveralFramesAreNamed) {
  expect_file_refused("frames.npy", {"2 frames of 3 points", "frames.npy:0", "frames.npy:-1"});
  expect_file_refused("frames.npy:2", {"no frame \"2\""});
  expect_file_refused("f8.npy:0", {"no frames"});
}

TEST(ForeignShape, RefusesHostileFiles) {
  expect_file_refused("malformed_cut.npy", {"72 bytes", "67", "cut off"});
  expect_file_refused("malformed_huge.npy", {"9223372036854775807 x 3", "allowed"});
  expect_file_refused("malformed_overflow.npy", {"768614336404564651 x 3", "allowed"});
  expect_file_refused("malformed_object.npy", {"\"|O\"", "allowed"});
  expect_file_refused("malformed_nan.npy", {"point 3: z = nan"});
  expect_file_refused("malformed_lying.npy", {"3 x 40", "transpose"});
}

TEST(ForeignShape, ArchivesAndXmlNameThePageThatConvertsThem) {
  const std::string page = "doc/howto/read_nodes.md";
  for (const std::string text :
       {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"/>\n", "\n <VTKFile/>"}) {
    EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_shape(text, "rod.vtu"); }),
                        {"rod.vtu: XML such as VTU or VTP", page}));
  }
  const std::string archive = std::string("PK\x03\x04") + std::string(40, '\0');
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_shape(archive, "rod.npz"); }),
                      {"rod.npz: a zip archive such as NPZ", page}));
  EXPECT_TRUE(has_all(error_of<InputError>([&] { return parse_markers(archive, "rod.npz"); }),
                      {"rod.npz", "allowed: CSV", page}));
}

TEST(ForeignShape, ACutArrayIsRefusedWhereverItIsCut) {
  const std::string name = "f8.npy";
  const std::string whole = read_file(corpus + name);
  for (std::size_t length = 1; length < whole.size(); ++length) {
    EXPECT_THROW((void)parse_shape(whole.substr(0, length), name), InputError)
        << "cut at " << length;
  }
}

}  // namespace
}  // namespace dlo::compare
