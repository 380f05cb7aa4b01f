#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "figure/gnuplot.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"
#include "judge/budget_parts.hpp"
#include "picture/budget_figure.hpp"
#include "picture/check_figure.hpp"
#include "picture/comparison_figure.hpp"
#include "picture/fit_figure.hpp"
#include "picture/map_figure.hpp"
#include "picture/solution_figure.hpp"
#include "picture/sweep_figure.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The line of a plot command that draws a series.
std::string line_of(const Figure& figure, const std::string& series) {
  for (const Panel& panel : figure.panels) {
    std::istringstream script(panel.script);
    for (std::string line; std::getline(script, line);) {
      if (line.find("'" + series + "'") != std::string::npos) return line;
    }
  }
  return {};
}

/// Rows of a series in the CSV file.
std::vector<std::vector<double>> rows_of(const Figure& figure, const std::string& series) {
  std::vector<std::vector<double>> rows;
  std::istringstream csv(figure.csv);
  for (std::string line; std::getline(csv, line);) {
    if (line.rfind(series + ",", 0) != 0) continue;
    std::istringstream fields(line.substr(series.size() + 1));
    std::vector<double>& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) {
      row.push_back(field.empty() ? NAN : std::strtod(field.c_str(), nullptr));
    }
  }
  return rows;
}

TEST(ShapePanels, HaveAsManyPixelsAMetreOnBothAxes) {
  const Scene scene = test::heavy_scene(5, -30);
  const Solution solution = solve(scene, Model::energy);
  const Series series{.id = "rod", .points = solution.shape.points};
  const Panel panel = shape_panels("a.csv", {series}, {{0, 1}}).front();
  const auto range = [&](const std::string& axis) {
    const std::size_t at = panel.script.find("set " + axis + "range [") + 12;
    const double from = std::stod(panel.script.substr(at));
    return std::stod(panel.script.substr(panel.script.find(':', at) + 1)) - from;
  };
  EXPECT_NEAR(plot_width / range("x"), panel.height / range("y"), 1e-4 * plot_width / range("x"));
}

// A digit is 10 pixels wide, a point or a minus 5 to 6.
TEST(ShapePanels, HaveNumbersBelowThatDoNotTouch) {
  for (double reach = 0.2; reach < 3; reach *= 1.07) {
    Series series{.id = "rod"};
    series.points = Eigen::Matrix3Xd::Zero(3, 2);
    series.points(0, 0) = -0.4 * reach;
    series.points(0, 1) = 0.6 * reach;
    const std::string script = shape_panels("a.csv", {series}, {{0, 1}}).front().script;
    const auto number_after = [&script](const std::string& words) {
      return std::stod(script.substr(script.find(words) + words.size()));
    };
    const double step = number_after("set xtics ");
    const double spacing = step * number_after("aspect: ");
    EXPECT_LT(spacing, plot_width / 2.0) << reach;
    // The second one to the left of the middle: minus, zero, point and its digits.
    const int digits = static_cast<int>(std::ceil(-std::log10(step) - 1e-9));
    const double width = step < 1 ? 6 + 10 + 5 + 10 * digits : 6 + 10;
    EXPECT_GT(spacing, width) << reach << ": " << step;
  }
}

TEST(SolutionPicture, DashesWhatIsUnstable) {
  const Scene scene = test::heavy_scene(100, 20);
  const AllSolutions all = solve_all(scene, {}, equal_arc_lengths(scene.length, 101));
  const Picture picture = solution_picture(scene, all.solutions);
  const Figure& shapes = picture.rows.at(0).at(0).at(0);
  std::size_t unstable = 0;
  for (std::size_t i = 0; i < all.solutions.size(); ++i) {
    const std::string line = line_of(shapes, "solution_" + std::to_string(i + 1));
    const bool dashed = all.solutions[i].smallest_eigenvalue < 0;
    unstable += dashed ? 1 : 0;
    EXPECT_THAT(line, HasSubstr(dashed ? "dashtype 2" : "dashtype 1"));
    EXPECT_THAT(line, HasSubstr(dashed ? ": unstable" : ": stable"));
  }
  EXPECT_GT(unstable, 0U);
  EXPECT_LT(unstable, all.solutions.size());
  EXPECT_FALSE(line_of(shapes, "gripper").empty());
  EXPECT_FALSE(line_of(shapes, "clamp_1").empty());
}

TEST(SolutionPicture, TellsElevenUnstableShapesApart) {
  const Scene scene = test::heavy_scene(2, 0);
  std::vector<Solution> all(12, solve(scene, Model::energy));
  for (std::size_t i = 1; i < all.size(); ++i)
    all[i].status = dlo::energy_model::SolveStatus::saddle;
  const Picture picture = solution_picture(scene, all);
  std::set<std::string> looks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string line =
        line_of(picture.rows.at(0).at(0).at(0), "solution_" + std::to_string(i + 1));
    looks.insert(line.substr(line.find(" with lines ")));
  }
  EXPECT_EQ(looks.size(), all.size());
}

TEST(SolutionPicture, ShowsCurvatureWithTheSenseOfTurning) {
  const Scene scene = test::heavy_scene(2, 0);
  const Solution solution = solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, 101));
  const Figure shapes = solution_picture(scene, {solution}).rows.at(0).at(0).at(0);
  const auto rows = rows_of(shapes, "solution_1");
  ASSERT_EQ(rows.size(), 101U);
  for (std::size_t i = 0; i < 90; ++i) {
    // It sinks to the right, so it turns to the right.
    EXPECT_NEAR(rows[i].at(4), -solution.curvature[i], 1e-8 * solution.curvature[0]) << i;
  }
}

// A rod that gives way out of its scene's plane turns neither left nor right.
TEST(SolutionPicture, ShowsARodThatLeavesItsPlaneFromTwoSidesAndItsCurvatureWithoutASense) {
  Scene scene = test::heavy_scene(1, 0);
  scene.grippers.push_back(
      {.at = 1, .position = {0.5, 0, 0}, .direction = Eigen::Vector3d::UnitX()});
  ASSERT_TRUE(scene.planar());
  const Solution solution = solve(scene, Model::energy);
  ASSERT_GT(solution.shape.points.row(2).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_FALSE(stays_in_plane(scene, solution.shape.points));
  const Figure shapes = solution_picture(scene, {solution}).rows.at(0).at(0).at(0);
  EXPECT_EQ(shapes.panels.size(), 2U);
  const auto rows = rows_of(shapes, "solution_1");
  EXPECT_FALSE(rows.empty());
  for (const std::vector<double>& row : rows) EXPECT_GE(row.at(4), 0);
}

// The key is below the second projection, whose own outlines it names.
TEST(SolutionPicture, NamesObstaclesInTheKeyOfBothKindsOfPicture) {
  for (const double sideways : {0.0, 0.02}) {
    Scene scene = test::heavy_scene(5, 0);
    scene.loads = {{.at = scene.length, .force = {0, 0, sideways}}};
    scene.obstacles = {{.body = obstacle::Body::sphere({0.5, -0.8, 0}, 0.1)}};
    const Picture picture = solution_picture(scene, {solve(scene, Model::energy)});
    const Panel& last = picture.rows.front().front().front().panels.back();
    EXPECT_EQ(picture.rows.front().front().front().panels.size(), sideways == 0 ? 1U : 2U);
    EXPECT_THAT(last.script, HasSubstr("title \"obstacles"));
    std::size_t titles = 0;
    for (std::size_t at = last.script.find(" title "); at != std::string::npos;
         at = last.script.find(" title ", at + 1)) {
      ++titles;
    }
    EXPECT_EQ(titles, static_cast<std::size_t>(last.key_rows));
  }
}

TEST(CheckPicture, MarksTheWorstPointAndJoinsEachPointWithItsPlaceOnTheRod) {
  const Scene scene = test::heavy_scene(2, -30);
  MeasuredShape shape{.file = "mine.csv"};
  const Solution rod = solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, 9));
  shape.points = rod.shape.points;
  shape.arc_length = rod.shape.arc_length;
  constexpr double off = 0.03;
  shape.points(1, 5) += off;
  const ShapeCheck check = check_shape(scene, shape, {.modulus = ModulusSearch::no});
  const Picture picture = check_picture(scene, check, 0.02);
  const Figure& shapes = picture.rows.at(0).at(0).at(0);
  const auto worst = rows_of(shapes, "worst");
  ASSERT_EQ(worst.size(), 1U);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(worst[0].at(static_cast<std::size_t>(axis) + 1), shape.points(axis, 5), 1e-9);
  }
  const auto whiskers = rows_of(shapes, "whisker");
  ASSERT_EQ(whiskers.size(), 18U);
  EXPECT_NEAR(whiskers[11].at(2) - whiskers[10].at(2), off, 1e-6);
  const Figure& distance = picture.rows.at(0).at(1).at(0);
  EXPECT_NEAR(rows_of(distance, "distance").at(5).at(1), off, 1e-6);
  EXPECT_THAT(distance.panels.front().script, HasSubstr("tolerance 20 mm"));
}

TEST(ComparisonFigures, ShowTheDeviationThatIsTold) {
  Scene scene = test::heavy_scene(2, -30);
  scene.force_model.points = 8;
  const Comparison comparison = compare(scene, {}, std::nullopt, ModulusSearch::no);
  const ComparisonFigures figures = comparison_figures(scene, {comparison}, 1);
  double largest = 0;
  for (const auto& row : rows_of(figures.deviation, "force")) largest = std::max(largest, row[1]);
  EXPECT_NEAR(largest, comparison.deviation.max_m, 1e-9 * largest);
  const auto marked = rows_of(figures.deviation, "force_largest");
  ASSERT_EQ(marked.size(), 1U);
  EXPECT_NEAR(marked[0].at(0), comparison.deviation.max_at_m, 1e-9);
  EXPECT_FALSE(line_of(figures.shapes, "force").empty());
  EXPECT_FALSE(line_of(figures.shapes, "energy").empty());
}

TEST(BudgetFigure, HasBarsThatAddUpToTheTotal) {
  Scene scene = test::heavy_scene(2, -30);
  scene.force_model.points = 8;
  scene.force_model.law = BendingLaw::paper;
  const Comparison comparison = compare(scene, {}, std::nullopt, ModulusSearch::no);
  const Figure figure = budget_figure({comparison}, 1);
  const auto rows = rows_of(figure, "setting_1");
  EXPECT_EQ(rows.size(), shown_parts(comparison).size());
  double sum = 0;
  for (const auto& row : rows) sum += row.at(1) + row.at(2);
  EXPECT_NEAR(sum, 100, 1e-6);
  EXPECT_THAT(figure.csv, AllOf(HasSubstr("law: "), Not(HasSubstr("twist"))));
}

TEST(SweepPicture, DrawsLinesForAFewValuesOfTheSecondFieldAndElseAMap) {
  SweptField x{.column = "gamma", .values = {"1", "10"}, .logarithmic = true};
  SweptField y{.column = "rod.length [m]", .values = {"1", "2"}};
  const std::string header = "row,gamma,rod.length [m],energy_J,status\n";
  const std::vector<std::string> rows = {"0,1,1,5,ok\n", "1,1,2,6,ok\n", "2,10,1,7,ok\n",
                                         "3,10,2,8,ok\n"};
  const auto script = [&] {
    return sweep_picture({x, y}, header, rows, {"energy_J"})
        .rows.at(0)
        .at(0)
        .at(0)
        .panels.at(0)
        .script;
  };
  EXPECT_THAT(script(),
              AllOf(HasSubstr("set logscale x"), HasSubstr("every 2::0 using 2:4"),
                    HasSubstr("every 2::1 using 2:4"), HasSubstr("'rod.length [m] = 2'")));
  y.values = {"1", "2", "3", "4", "5", "6", "7"};
  EXPECT_THAT(script(), AllOf(HasSubstr("palette"), HasSubstr("using 2:3:4")));
  y.values.back() = "steel";
  EXPECT_THAT(script(), Not(HasSubstr("palette")));
  x.values.back() = "steel";
  EXPECT_THROW((void)script(), InputError);
}

TEST(MapFigure, HasTheAxisThatVaries) {
  StabilityMap map{.scene = "a", .axis = MapAxis::c_h};
  EXPECT_THAT(map_figure(map).panels.at(0).script,
              AllOf(HasSubstr("set logscale y"), HasSubstr("? $3 : NaN):4")));
  map.axis = MapAxis::c_c;
  EXPECT_THAT(map_figure(map).panels.at(0).script,
              AllOf(HasSubstr("set logscale xy"), HasSubstr("? $2 : NaN):4")));
}

TEST(FitPicture, HasAProfileThatReachesItsLimitAtTheEndsOfTheInterval) {
  const Scene scene = test::heavy_scene(2, -30);
  MeasuredShape shape{.file = "seen.csv"};
  const Solution rod = solve(scene, Model::energy, {}, equal_arc_lengths(scene.length, 12));
  shape.points = rod.shape.points;
  shape.arc_length = rod.shape.arc_length;
  for (Eigen::Index i = 0; i < 12; ++i) shape.points(1, i) += (i % 2 == 0 ? 1 : -1) * 1e-3;
  const MaterialFit fit = fit_material({scene}, {shape}, {.profile_points = 5});
  ASSERT_TRUE(fit.youngs_modulus.low && fit.youngs_modulus.high);
  ASSERT_EQ(fit.profile.size(), 5U);
  // Half a width below the interval, its low end, its middle, its high end, half a width above.
  EXPECT_NEAR(fit.profile[1].stiffness / *fit.youngs_modulus.low, 1, 1e-9);
  EXPECT_NEAR(fit.profile[3].stiffness / *fit.youngs_modulus.high, 1, 1e-9);
  EXPECT_NEAR(fit.profile[1].excess_over_limit, 1, 1e-2);
  EXPECT_NEAR(fit.profile[3].excess_over_limit, 1, 1e-2);
  EXPECT_LT(fit.profile[2].excess_over_limit, 0.05);
  EXPECT_GT(fit.profile[0].excess_over_limit, 2);
  const Picture picture = fit_picture({scene}, fit);
  ASSERT_EQ(picture.rows.at(0).size(), 2U);
  const Figure& drawn = picture.rows[0][1].at(0);
  EXPECT_EQ(rows_of(drawn, "rod").size(), 201U);
  EXPECT_EQ(rows_of(drawn, "file").size(), 12U);
}

TEST(PictureScript, NamesItsTerminal) {
  const Figure figure{.name = "a", .title = "it's `a` title", .csv_file = "a.csv", .panels = {{}}};
  const Picture picture{{{{figure}, {figure}}, {{figure, figure}}}};
  EXPECT_THAT(picture_script(picture, PictureFormat::svg, "plot.svg"),
              AllOf(HasSubstr("set terminal svg size 920,"),
                    HasSubstr(R"("it\047s \140a\140 title")"), HasSubstr("set output 'plot.svg'")));
  EXPECT_THAT(picture_script(picture, PictureFormat::png, "plot.png"),
              HasSubstr("set terminal pngcairo size 1840,"));
  EXPECT_THAT(picture_script(picture, PictureFormat::pdf, "plot.pdf"),
              HasSubstr("set terminal pdfcairo"));
}

/// Width of a letter over that of a picture, as gnuplot has it once it has drawn one.
double letter_share(PictureFormat format, const std::filesystem::path& folder) {
  const Figure figure{.name = "a", .title = "a", .panels = {{.script = "plot x\n"}}};
  std::ofstream(folder / "a.gp") << picture_script({{{{figure}}}}, format, "a.out")
                                 << "set print 'share'\n"
                                    "print real(GPVAL_TERM_HCHAR) / GPVAL_TERM_XSIZE\n";
  EXPECT_EQ(run_script("a.gp", "a.out", folder), "");
  double share = 0;
  std::ifstream(folder / "share") >> share;
  return share;
}

TEST(PictureScript, WritesLettersOfTheSameSizeInEveryFormat) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("dlo_letters_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  if (gnuplot_version(folder).empty()) GTEST_SKIP() << "there is no gnuplot";
  const double png = letter_share(PictureFormat::png, folder);
  EXPECT_NEAR(letter_share(PictureFormat::pdf, folder) / png, 1, 0.05);
  // gnuplot guesses the width of a letter that the SVG's reader draws: 0.7 of its height.
  EXPECT_NEAR(letter_share(PictureFormat::svg, folder), 0.7 * 16 / figure_width, 1e-4);
  EXPECT_NEAR(png * figure_width / 16, 0.6, 0.1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace dlo::compare
