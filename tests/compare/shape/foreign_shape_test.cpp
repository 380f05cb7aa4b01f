// Shapes as other programs write them. The files of tests/fuzz/corpus/shape that are read here were
// written by NumPy, and by hand to VTK's description of its XML formats.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {
namespace {

using test::error_of;
using test::says;
using test::says_none;

const std::string corpus = DLO_FUZZ_CORPUS "/shape/";

void expect_file_points(const std::string& name, double rounding = 0, double unit = 1) {
  Eigen::Matrix3Xd expected(3, 3);
  expected << 0, 0.1, 0.2, 0, -0.01, -0.03, 0, 0, 0.5;
  const MeasuredShape shape = load_shape(corpus + name, unit);
  ASSERT_EQ(shape.points.cols(), 3) << name;
  EXPECT_LE((shape.points - expected).cwiseAbs().maxCoeff(), rounding) << name;
}

/// Of a binary32 near 0.5, half a unit in the last place.
constexpr double rounding_of_float = 3e-8;

TEST(ForeignShape, ReadsNumPyArraysOfAnyTypeAndOrder) {
  expect_file_points("f8.npy");
  expect_file_points("big_f4_fortran.npy", rounding_of_float);
  const MeasuredShape plane = load_shape(corpus + "two_columns_i2.npy", 1e-3);
  EXPECT_EQ(plane.points.row(2).norm(), 0);
  EXPECT_DOUBLE_EQ(plane.points(0, 2), 0.2);
  EXPECT_DOUBLE_EQ(plane.points(1, 2), -0.03);
}

TEST(ForeignShape, TheNameChoosesAnArrayAndAFrame) {
  expect_file_points("stored.npz");  // the other array is a number
  expect_file_points("stored.npz:xpos");
  expect_file_points("frames.npy:1");
  expect_file_points("frames.npy:-1");
  expect_file_points("deflated.npz:xpos:1", rounding_of_float);
  expect_file_points("fortran_frames.npz:xpos:-1");
}

TEST(ForeignShape, ReadsVtkXmlPlainAndPacked) {
  expect_file_points("ascii.vtp");
  EXPECT_EQ(load_shape(corpus + "ascii.vtp").arc_length, (std::vector<double>{0, 0.11, 0.25}));
  expect_file_points("ascii.vtp", 0, 1e-3);  // with arc_length_m a file is in metres
  expect_file_points("base64.vtu", rounding_of_float);
  expect_file_points("raw.vtu");
  expect_file_points("raw_packed.vtp");
  expect_file_points("base64_packed_big.vtu");
  expect_file_points("base64_plain.vtp");
}

TEST(ForeignShape, ATableOfNodesNeedsNoHeader) {
  expect_file_points("nodes.csv");
  expect_file_points("nodes_more.csv");
  EXPECT_EQ(load_shape(corpus + "nodes_more.csv").notes.size(), 1U);
  // A fourth column that is as long as the way along the first three is the arc length.
  const std::string whole = "0 0 0 0\n1 0 0 1\n2 1 0 2.5\n";
  EXPECT_EQ(parse_shape(whole, "f", 1e-3).arc_length.size(), 3U);
  EXPECT_TRUE(parse_shape("0 0 0 0\n1 0 0 -1\n2 1 0 2.5\n", "f").arc_length.empty());
  const MeasuredShape named = parse_shape("node,x,y,z,u_x\n1,0,0,0,7\n2,0.1,0,0,7\n", "f");
  EXPECT_EQ(named.points(0, 1), 0.1);
  ASSERT_EQ(named.notes.size(), 1U);
  EXPECT_TRUE(says(named.notes[0], {"u_x"}));
}

void expect_file_refused(const std::string& name, const std::vector<std::string>& pieces) {
  const std::string message = error_of<InputError>([&] { return load_shape(corpus + name); });
  EXPECT_TRUE(says_none(message, {"\n"}));
  EXPECT_TRUE(says(message, pieces));
}

TEST(ForeignShape, SeveralArraysAndFramesAreNamed) {
  expect_file_refused("frames.npy", {"2 frames of 3 points", "frames.npy:0", "frames.npy:-1"});
  expect_file_refused("frames.npy:2", {"no frame \"2\""});
  expect_file_refused("f8.npy:0", {"no frames"});
  expect_file_refused("deflated.npz", {"several arrays", "\"a\" (3 x 3)", "\"xpos\" (2 x 3 x 3)"});
  expect_file_refused("deflated.npz:xpos", {"2 frames", "deflated.npz:xpos:-1"});
  expect_file_refused("deflated.npz:b", {"no array \"b\"", "\"a\", \"xpos\""});
}

TEST(ForeignShape, RefusesHostileFiles) {
  expect_file_refused("malformed_cut.npy", {"72 bytes", "67", "cut off"});
  expect_file_refused("malformed_huge.npy", {"9223372036854775807 x 3", "allowed"});
  expect_file_refused("malformed_overflow.npy", {"768614336404564651 x 3", "allowed"});
  expect_file_refused("malformed_object.npy", {"\"|O\"", "allowed"});
  expect_file_refused("malformed_nan.npy", {"point 3: z = nan"});
  expect_file_refused("malformed_lying.npy", {"3 x 40", "transpose"});
  expect_file_refused("malformed_bomb.npz", {"3000000000 bytes", "allowed: up to 67108864"});
  expect_file_refused("malformed_size.npz", {"xpos.npy", "damaged"});
  expect_file_refused("malformed_damaged.npz", {"malformed_damaged.npz"});
  expect_file_refused("malformed_cut.npz", {"cut off"});
  expect_file_refused("malformed_cut.vtu", {"cut off"});
  expect_file_refused("malformed_offset.vtu", {"offset = \"9999999\"", "appended"});
  expect_file_refused("malformed_entity.vtp", {":1:", "document type"});
  expect_file_refused("malformed_blocks.vtp", {"Points", "allowed"});
  expect_file_refused("malformed_xml.vtp", {"malformed_xml.vtp:2:"});
}

TEST(ForeignShape, ACutFileIsRefusedWhereverItIsCut) {
  for (const char* name : {"f8.npy", "stored.npz", "raw.vtu", "raw_packed.vtp", "ascii.vtp",
                           "base64_packed_big.vtu"}) {
    std::ifstream stream(corpus + name, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stream), {}};
    // What is behind the end of VTK's last element is blank.
    for (std::size_t length = 1; length + 2 < whole.size(); ++length) {
      EXPECT_THROW((void)parse_shape(whole.substr(0, length), name), InputError)
          << name << " cut at " << length;
    }
  }
}

}  // namespace
}  // namespace dlo::compare
