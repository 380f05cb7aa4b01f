// Tests that a locale with a decimal comma does not change how files are read and written.

#include <gtest/gtest.h>

#include <clocale>
#include <cstdlib>
#include <fstream>
#include <locale>
#include <sstream>
#include <string>

#include "batch/baseline.hpp"
#include "batch/sweep_grid.hpp"
#include "command_fixture.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "shape/write_vtk.hpp"
#include "toml/quantity.hpp"

namespace dlo::compare {
namespace {

class CommaPunctuation : public std::numpunct<char> {
 protected:
  [[nodiscard]] char do_decimal_point() const override { return ','; }
  [[nodiscard]] char do_thousands_sep() const override { return '.'; }
  [[nodiscard]] std::string do_grouping() const override { return "\3"; }
};

/// Fixture that sets a locale with a decimal comma in the C++ library, and in the C library too if
/// localedef can make one.
class DecimalComma : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    before_ = std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
    std::ofstream(path("source")) << "LC_NUMERIC\ndecimal_point \"<U002C>\"\nthousands_sep "
                                     "\"<U002E>\"\ngrouping 3;3\nEND LC_NUMERIC\n";
    (void)run_line("localedef -c -i " + path("source") + " -f UTF-8 " + path("decimal_comma"));
    ::setenv("LOCPATH", path("").c_str(), 1);
    has_c_locale_ = std::setlocale(LC_NUMERIC, "decimal_comma") != nullptr;
  }
  void TearDown() override {
    std::setlocale(LC_ALL, "C");
    std::locale::global(before_);
    ::unsetenv("LOCPATH");
    Command::TearDown();
  }

  bool has_c_locale_ = false;

 private:
  std::locale before_;
};

constexpr const char* comma_scene = R"(name = "rod"
gravity = [0, -9.81, 0]
rod = { length = 0.5, diameter = "2.5 mm", material = { youngs_modulus = 5e8, density = 1100.25 } }
gripper = [{ at = 0, position = [0.125, 1e-1, 0], direction = "-12.5 deg" }]
)";

TEST_F(DecimalComma, IsInForce) {
  std::ostringstream text;
  text << 2500.5;
  EXPECT_EQ(text.str(), "2.500,5");
  if (!has_c_locale_) GTEST_SKIP() << "no locale with a decimal comma for the C library";
  EXPECT_EQ(std::strtod("2,5", nullptr), 2.5);
}

TEST_F(DecimalComma, ChangesNoFileThatIsRead) {
  EXPECT_DOUBLE_EQ(parse_quantity("2.5 mm", Dimension::length), 2.5e-3);
  const Scene scene = parse_scene(comma_scene, "s.toml");
  EXPECT_DOUBLE_EQ(scene.length, 0.5);
  EXPECT_DOUBLE_EQ(scene.diameter, 2.5e-3);
  EXPECT_DOUBLE_EQ(scene.material.density, 1100.25);
  EXPECT_DOUBLE_EQ(scene.grippers.front().position.y(), 0.1);
  for (const char* text :
       {"x,y\n0.25,1e-1\n1.5,2\n", "x;y\n0.25;0.1\n1.5;2\n", "[[0.25, 0.1], [1.5, 2]]",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n"
        "0.25 0.1 0 1.5 2 0\n"}) {
    const MeasuredShape shape = parse_shape(text, "shape", 1);
    EXPECT_DOUBLE_EQ(shape.points(0, 0), 0.25) << text;
    EXPECT_DOUBLE_EQ(shape.points(1, 0), 0.1) << text;
    EXPECT_DOUBLE_EQ(shape.points(0, 1), 1.5) << text;
  }
  const Axis axis = parse_axis("rod.length=lin:0.5 m:1500.5 m:3");
  EXPECT_EQ(axis.number(1), "750.5");
}

TEST_F(DecimalComma, ChangesNothingThatIsWritten) {
  const Scene scene = parse_scene(comma_scene, "s.toml");
  const Solution solution = solve(scene, Model::energy, {}, equal_arc_lengths(0.5, 3));
  const std::string vtk = vtk_polyline(
      solution.shape, {.curvature = solution.curvature, .tension = solution.tension}, "rod");
  EXPECT_TRUE(has_none(vtk, {","}));
  const MeasuredShape back = parse_shape(vtk, "shape.vtk", 1);
  EXPECT_TRUE(back.points.isApprox(solution.shape.points, 1e-12));
  BaselineCase entry = {.scene = "rod", .points = 1500};
  entry.errors = {0.125, 0.25, 0.5};
  const std::string text = baseline_text({entry});
  EXPECT_TRUE(has_all(text, {"points = 1500\nrms_over_length = 0.125"}));
  EXPECT_EQ(baseline_text(read_baseline(text, "b.toml")), text);
}

}  // namespace
}  // namespace dlo::compare
