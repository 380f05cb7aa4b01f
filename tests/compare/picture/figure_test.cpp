#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "figure/gnuplot.hpp"
#include "figure/series.hpp"
#include "picture/figures.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Returns the curve of a figure with a name; an empty curve if there is none.
PlottedCurve curve_of(const Figure& figure, const std::string& id) {
  for (const Panel& panel : figure.panels) {
    for (const PlottedCurve& curve : panel.curves) {
      if (curve.id == id) return curve;
    }
  }
  return {};
}

PlottedCurve titled(const Panel& panel, const std::string& title) {
  for (const PlottedCurve& curve : panel.curves) {
    if (curve.title.find(title) != std::string::npos) return curve;
  }
  return {};
}

/// Returns a rod that lies on a table, so that its height is negligible.
Scene flat_scene() {
  Scene scene = test::heavy_scene(20, 0);
  const Eigen::Vector3d under(0, -0.04 * scene.length, 0);
  scene.obstacles = {{.body = obstacle::Body::half_space(under, Eigen::Vector3d::UnitY())}};
  return scene;
}

/// Returns points of a rod. The sixth one is displaced by `off` [m] along y.
MeasuredShape measured(const Scene& scene, int points, double off) {
  MeasuredShape shape{.file = "mine.csv"};
  const Solution rod = solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, points));
  shape.points = rod.shape.points;
  shape.arc_length = rod.shape.arc_length;
  shape.points(1, 5) += off;
  return shape;
}

TEST(Panel, PutsWhatIsInfiniteAtItsEdgeAndDropsCurvesOfNothing) {
  Panel panel{.x = {.from = 0, .to = 2}, .y = {.logarithmic = true}};
  panel.curves = {{.title = "level", .x = {-HUGE_VAL, HUGE_VAL}, .y = {3, 3}},
                  {.title = "none", .x = {1}, .y = {NAN}},
                  {.title = "on no logarithmic axis", .x = {1}, .y = {0}}};
  panel = laid_out(panel);
  ASSERT_EQ(panel.curves.size(), 1U);
  EXPECT_EQ(panel.curves.front().title, "level");
  EXPECT_THAT(panel.curves.front().x, testing::ElementsAre(0, 2));
  EXPECT_LT(*panel.y.from, 3);
  EXPECT_GT(*panel.y.to, 3);
}

std::filesystem::path drawing_folder() {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("dlo_drawing_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

TEST(PictureScript, LeavesTicsAndLegendsToGnuplot) {
  const Scene scene = flat_scene();
  const ShapeCheck check =
      check_shape(scene, measured(scene, 9, 0.03), {.modulus = ModulusSearch::no});
  const Picture picture = check_picture(scene, check, 0.02);
  const std::string script = picture_script(picture, PictureFormat::svg, "a.svg");
  EXPECT_THAT(script, AllOf(HasSubstr("set size ratio -1"), HasSubstr("set key below"),
                            HasSubstr("set xtics nomirror\n"), Not(HasSubstr("xtics ("))));
  const std::filesystem::path folder = drawing_folder();
  if (gnuplot_version(folder).empty()) GTEST_SKIP() << "there is no gnuplot";
  std::ofstream(folder / "a.gp") << script;
  EXPECT_EQ(run_script("a.gp", "a.svg", folder), "");
  std::ostringstream drawn;
  drawn << std::ifstream(folder / "a.svg").rdbuf();
  std::size_t titles = 0;
  for (const std::vector<Figure>& column : picture.rows.at(0)) {
    const Panel panel = laid_out(column.at(0).panels.at(0));
    for (const PlottedCurve& curve : panel.curves) {
      if (!panel.shows_title(curve)) continue;
      EXPECT_THAT(drawn.str(), HasSubstr(curve.title));
      ++titles;
    }
  }
  EXPECT_EQ(titles, 10U);
  std::filesystem::remove_all(folder);
}

TEST(SolutionPicture, DashesWhatIsUnstable) {
  const Scene scene = test::heavy_scene(100, 20);
  const AllSolutions all = solve_all(scene, {}, equal_arc_lengths(scene.length, 101));
  const Picture picture = solution_picture(scene, all.solutions);
  const Figure& shapes = picture.rows.at(0).at(0).at(0);
  std::size_t unstable = 0;
  for (std::size_t i = 0; i < all.solutions.size(); ++i) {
    const PlottedCurve line = curve_of(shapes, "solution_" + std::to_string(i + 1));
    const bool dashed = all.solutions[i].smallest_eigenvalue < 0;
    unstable += dashed ? 1 : 0;
    EXPECT_EQ(line.look.dashes, dashed ? Dashes::dashed : Dashes::solid);
    EXPECT_THAT(line.title, HasSubstr(dashed ? ": unstable" : ": stable"));
  }
  EXPECT_GT(unstable, 0U);
  EXPECT_LT(unstable, all.solutions.size());
  EXPECT_FALSE(curve_of(shapes, "gripper").x.empty());
  EXPECT_FALSE(curve_of(shapes, "clamp_1").x.empty());
}

TEST(SolutionPicture, ShowsCurvatureWithTheSenseOfTurning) {
  const Scene scene = test::heavy_scene(2, 0);
  const Solution solution = solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, 101));
  const Figure drawn = solution_picture(scene, {solution}).rows.at(0).at(1).at(0);
  const std::vector<double> curvature = curve_of(drawn, "solution_1").y;
  ASSERT_EQ(curvature.size(), 101U);
  for (std::size_t i = 0; i < 90; ++i) {
    // The rod sinks to the right, so it bends to the right.
    EXPECT_NEAR(curvature[i], -solution.curvature[i], 1e-8 * solution.curvature[0]) << i;
  }
}

// The curvature of a rod that leaves its scene's plane has no sign.
TEST(SolutionPicture, ShowsARodThatLeavesItsPlaneFromTwoSidesAndItsCurvatureWithoutASense) {
  Scene scene = test::heavy_scene(1, 0);
  scene.grippers.push_back(
      {.at = 1, .position = {0.5, 0, 0}, .direction = Eigen::Vector3d::UnitX()});
  ASSERT_TRUE(scene.planar());
  const Solution solution = solve(scene, Model::energy);
  ASSERT_GT(solution.shape.points.row(2).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_FALSE(stays_in_plane(scene, solution.shape.points));
  const Picture picture = solution_picture(scene, {solution});
  EXPECT_EQ(picture.rows.at(0).at(0).at(0).panels.size(), 2U);
  const std::vector<double> curvature = curve_of(picture.rows.at(0).at(1).at(0), "solution_1").y;
  EXPECT_FALSE(curvature.empty());
  EXPECT_THAT(curvature, testing::Each(testing::Ge(0)));
}

BenchmarkRun run(int size, double seconds, double rms, bool front) {
  BenchmarkRun run{.model = Model::chain, .size = size};
  run.variant.emplace();
  run.time.median_s = seconds;
  run.rms_over_length = rms;
  run.front = front;
  return run;
}

TEST(FrontFigure, TellsNAtThePointsOfTheFront) {
  SceneBenchmark scene;
  scene.runs = {run(64, 4e-3, 1e-5, true), run(8, 1e-3, 1e-2, true), run(16, 5e-3, 1e-3, false)};
  const Panel panel = front_figure(scene).panels.at(0);
  ASSERT_EQ(panel.texts.size(), 2U);
  EXPECT_EQ(panel.texts[0].words, "8");
  EXPECT_EQ(panel.texts[1].words, "64");
  const PlottedCurve front = titled(panel, "the front");
  EXPECT_THAT(front.x, testing::ElementsAre(1, 4));
  EXPECT_EQ(panel.texts[1].x, front.x[1]);
  EXPECT_EQ(panel.texts[1].y, front.y[1]);
}

TEST(SweepPicture, DrawsLinesForAFewValuesOfTheSecondFieldAndElseAMap) {
  SweptField x{.column = "gamma", .values = {"1", "10"}, .logarithmic = true};
  SweptField y{.column = "rod.length [m]", .values = {"1", "2"}};
  const std::string header = "row,gamma,rod.length [m],energy_J,status\n";
  const std::vector<std::string> rows = {"0,1,1,5,ok\n", "1,1,2,6,ok\n", "2,10,1,7,ok\n",
                                         "3,10,2,8,ok\n"};
  const auto panel = [&] {
    return sweep_picture({x, y}, header, rows, {"energy_J"}).rows.at(0).at(0).at(0).panels.at(0);
  };
  const Panel lines = panel();
  EXPECT_TRUE(lines.x.logarithmic);
  ASSERT_EQ(lines.curves.size(), 2U);
  EXPECT_THAT(lines.curves[0].y, testing::ElementsAre(5, 7));
  EXPECT_THAT(lines.curves[1].x, testing::ElementsAre(1, 10));
  EXPECT_THAT(lines.curves[1].y, testing::ElementsAre(6, 8));
  EXPECT_EQ(lines.curves[1].title, "rod.length [m] = 2");
  y.values = {"1", "2", "3", "4", "5", "6", "7"};
  EXPECT_TRUE(panel().cells);
  y.values.back() = "steel";
  EXPECT_FALSE(panel().cells);
  x.values.back() = "steel";
  EXPECT_THROW((void)panel(), InputError);
}

// Adjacent cells of the map share their edges, also if the values of a field decrease.
TEST(SweepPicture, HasAMapWhoseCellsMeet) {
  const SweptField x{.column = "gamma", .values = {"1", "10", "100"}, .logarithmic = true};
  const SweptField y{.column = "length", .values = {"7", "6", "5", "4", "3", "2", "1"}};
  std::vector<std::string> rows;
  for (const std::string& gamma : x.values) {
    for (const std::string& length : y.values) {
      rows.push_back("0," + gamma + ",\"a, b\"," +
                     std::to_string(std::stod(gamma) + std::stod(length)) + "\n");
    }
  }
  const Panel panel =
      sweep_picture({x, y}, "row,gamma,length,sum\n", rows, {"sum"}).rows[0][0][0].panels[0];
  const Cells& cells = panel.cells.value();
  ASSERT_EQ(cells.x.size(), 4U);
  EXPECT_THAT(cells.y, testing::ElementsAre(0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(std::log10(cells.x[i]), double(i) - 0.5, 1e-12);
  EXPECT_THAT(cells.range(), testing::Pair(2, 107));
  EXPECT_EQ(cells.values.front(), 2);
  EXPECT_EQ(cells.values[2], 101);
  EXPECT_EQ(cells.values.back(), 107);
}

TEST(MapFigure, HasTheAxisThatVaries) {
  StabilityMap map{.scene = "a", .axis = MapAxis::c_h};
  map.points = {{.c_c = 2, .c_h = 0.5, .c_F = 3, .outcome = Outcome::diverges}};
  for (const MapAxis axis : {MapAxis::c_h, MapAxis::c_c}) {
    map.axis = axis;
    const Panel panel = map_figure(map).panels.at(0);
    EXPECT_TRUE(panel.y.logarithmic);
    EXPECT_EQ(panel.x.logarithmic, axis == MapAxis::c_c);
    const PlottedCurve diverges = titled(panel, "diverges");
    EXPECT_THAT(diverges.x, testing::ElementsAre(axis == MapAxis::c_c ? 2 : 0.5));
    EXPECT_THAT(diverges.y, testing::ElementsAre(3));
  }
}

TEST(FitPicture, HasAProfileThatReachesItsLimitAtTheEndsOfTheInterval) {
  const Scene scene = test::heavy_scene(2, -30);
  MeasuredShape shape = measured(scene, 12, 0);
  for (Eigen::Index i = 0; i < 12; ++i) shape.points(1, i) += (i % 2 == 0 ? 1 : -1) * 1e-3;
  const MaterialFit fit = fit_material({scene}, {shape}, {.profile_points = 5});
  ASSERT_TRUE(fit.youngs_modulus.low && fit.youngs_modulus.high);
  ASSERT_EQ(fit.profile.size(), 5U);
  // Half a width below the interval, its low end, its middle, its high end, half a width above.
  EXPECT_NEAR(fit.profile[1].excess_over_limit, 1, 1e-2);
  EXPECT_NEAR(fit.profile[3].excess_over_limit, 1, 1e-2);
  const Picture picture = fit_picture({scene}, fit);
  ASSERT_EQ(picture.rows.at(0).size(), 2U);
  const Figure& drawn = picture.rows[0][1].at(0);
  EXPECT_EQ(curve_of(drawn, "rod").x.size(), 201U);
  EXPECT_EQ(curve_of(drawn, "file").x.size(), 12U);
}

TEST(PictureScript, NamesItsTerminal) {
  const Figure figure{.title = "it's `a` title", .panels = {{}}};
  const Picture picture{{{{figure}, {figure}}, {{figure, figure}}}};
  EXPECT_THAT(picture_script(picture, PictureFormat::svg, "plot.svg"),
              AllOf(HasSubstr("set terminal svg size 920,"),
                    HasSubstr(R"("it\047s \140a\140 title")"), HasSubstr("set output 'plot.svg'")));
  EXPECT_THAT(picture_script(picture, PictureFormat::png, "plot.png"),
              HasSubstr("set terminal pngcairo size 1840,"));
  EXPECT_THAT(picture_script(picture, PictureFormat::pdf, "plot.pdf"),
              HasSubstr("set terminal pdfcairo"));
}

}  // namespace
}  // namespace dlo::compare
