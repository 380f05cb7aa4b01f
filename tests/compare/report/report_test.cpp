#include "report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "../../says.hpp"
#include "csv_table.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "report/folder.hpp"
#include "report/verdict.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using test::error_of;

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// One scene, nothing that takes long.
ReportOptions small_report() {
  ReportOptions options;
  options.history = false;
  options.benchmark.reset();
  options.grid.reset();
  options.motion = false;
  options.map.reset();
  options.hard_cases.reset();
  return options;
}

SceneFile heavy_file(const std::string& name = "heavy") {
  SceneFile file{.name = "heavy.toml", .text = "# heavy", .scene = test::heavy_scene(2, -30)};
  file.scene.name = name;
  file.scene.force_model.law = BendingLaw::paper;
  file.scene.force_model.bookkeeping = Bookkeeping::paper;
  file.scene.force_model.points = 8;
  return file;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Files of a folder by their paths in it.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) {
      files[entry.path().lexically_relative(folder).string()] = text_of(entry.path());
    }
  }
  return files;
}

/// A place to write reports to.
class ReportFolder : public testing::Test {
 protected:
  void SetUp() override {
    place_ = fs::temp_directory_path() / ("dlo_report_test_" + std::to_string(::getpid()));
    fs::create_directories(place_);
  }
  void TearDown() override { fs::remove_all(place_); }

  [[nodiscard]] fs::path place() const { return place_; }
  [[nodiscard]] std::string folder() const { return (place_ / "report").string(); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((place_ / name).parent_path());
    std::ofstream(place_ / name) << text;
  }
  [[nodiscard]] std::string page() const { return text_of(place_ / "report" / "index.html"); }
  void expect_refused(const std::string& to, const std::string& because) const {
    const std::map<std::string, std::string> before = contents(place_);
    EXPECT_THAT(error_of<InputError>([&] {
                  return write_report(make_report({heavy_file()}, small_report()), {}, to);
                }),
                AllOf(HasSubstr(to), HasSubstr(because), HasSubstr("allowed")));
    EXPECT_EQ(contents(place_), before);
  }

 private:
  fs::path place_;
};

/// Another PATH for as long as it lives.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) {
    ::setenv("PATH", path.c_str(), 1);
  }
  ~SearchPath() { ::setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;
  SearchPath(SearchPath&&) = delete;
  SearchPath& operator=(SearchPath&&) = delete;

 private:
  std::string before_;
};

/// As the page shows a number.
std::string shown(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return ">" + text.str() + "<";
}

TEST_F(ReportFolder, ShowsTheNumbersOfTheLibrary) {
  const SceneFile file = heavy_file();
  (void)write_report(make_report({file}, small_report()), {}, folder());
  Scene better = file.scene;
  better.force_model.law = BendingLaw::hooke;
  better.force_model.bookkeeping = Bookkeeping::consistent;
  const std::string html = page();
  for (const Scene& scene : {file.scene, better}) {
    const Comparison c = compare(scene);
    for (const double number :
         {c.deviation.rms_m * 1e3, c.deviation.max_m * 1e3, c.deviation.tip_m * 1e3,
          c.deviation.max_at_m, c.deviation.curvature_rms_per_m, c.budget.total_m * 1e3,
          c.effective_modulus.ratio, c.effective_modulus.rms_m * 1e3, c.force.parameters.c_c,
          c.force.c_F, c.gamma}) {
      EXPECT_THAT(html, HasSubstr(shown(number)));
    }
  }
  EXPECT_EQ(text_of(place() / "report" / "scenes" / "heavy.toml"), "# heavy");
}

TEST_F(ReportFolder, DrawsShapesWhereTheyAre) {
  const Report report = make_report({heavy_file()}, small_report());
  (void)write_report(report, {}, folder());
  // The CSV's force model, point by point.
  const auto rows = test::csv_numbers(
      test::rows_of_series(text_of(place() / "report" / "shapes_1.csv"), "force"), 0, 1);
  const Shape& shape = report.scenes.front().comparisons.front().force.shape;
  ASSERT_EQ(rows.size(), shape.arc_length.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].at(0), shape.arc_length[i], 1e-9);
    for (Eigen::Index k = 0; k < 2; ++k) {
      EXPECT_NEAR(rows[i].at(static_cast<std::size_t>(k) + 1),
                  shape.points(k, static_cast<Eigen::Index>(i)), 1e-9);
    }
  }
}

// A rod that hangs down onto a floor, beside a wall that it does not reach: the outline ends where
// its axis does, all points that touch are on it, and what is endless does not widen the plot.
TEST_F(ReportFolder, DrawsTheObstaclesInReachAndWhatTouches) {
  SceneFile file = heavy_file();
  file.scene.force_model = {.points = 32};
  const double l = file.scene.length;
  const double floor = file.scene.grippers.front().position.y() - 0.3 * l;
  file.scene.obstacles = {
      {.body = obstacle::Body::half_space({0, floor, 0}, {0, 1, 0})},
      {.body = obstacle::Body::half_space({9 * l, 0, 0}, {-1, 0, 0})},
      {.body = obstacle::Body::half_space({0, 0, -l / 2}, {0, 0, 1})},
  };
  const Report report = make_report({file}, small_report());
  (void)write_report(report, {}, folder());
  ASSERT_FALSE(report.scenes.front().comparisons.empty());
  ASSERT_FALSE(report.scenes.front().comparisons.front().contacts.empty());
  std::map<std::string, std::vector<double>> heights;
  for (const test::CsvRow& row : test::csv_rows(text_of(place() / "report" / "shapes_1.csv"))) {
    if (row.at(0) != "series") heights[row.at(0)].push_back(std::stod(row.at(3)));
  }
  ASSERT_EQ(heights.count("obstacle_1_xy"), 1U);
  EXPECT_EQ(heights.count("obstacle_2_xy"), 0U) << "out of reach";
  EXPECT_EQ(heights.count("obstacle_3_xy"), 0U) << "seen from above";
  const std::vector<double>& drawn = heights["obstacle_1_xy"];
  EXPECT_NEAR(*std::max_element(drawn.begin(), drawn.end()), floor, 1e-9 * l);
  ASSERT_FALSE(heights["contact"].empty());
  for (const double height : heights["contact"]) EXPECT_NEAR(height, floor, 1e-6 * l);
  const std::string script = text_of(place() / "report" / "shapes_1.gp");
  EXPECT_THAT(script, AllOf(HasSubstr("# obstacle_1_xy\n"), HasSubstr("# contact\n")));
  const std::size_t range = script.find("set yrange [") + 12;
  EXPECT_GT(std::stod(script.substr(range)), floor - 2 * l);
}

TEST_F(ReportFolder, ShowsTheCurvatureThatTheRodHas) {
  // Of a Hookean chain with the consistent bookkeeping every joint is near the rod's curvature,
  // also the first, whose one segment is half inside the gripper.
  SceneFile file = heavy_file();
  file.scene.force_model = {.points = 64};
  (void)write_report(make_report({file}, small_report()), {}, folder());
  std::map<double, double> rod;
  std::map<double, double> joints;
  for (const test::CsvRow& fields : test::csv_rows(text_of(place() / "report" / "shapes_1.csv"))) {
    if (fields.size() < 6 || fields[0] == "series" || fields[5].empty()) continue;
    (fields[0] == "energy" ? rod : joints)[std::stod(fields[1])] = std::stod(fields[5]);
  }
  ASSERT_EQ(rod.size(), 201U);
  ASSERT_EQ(joints.size(), 62U);
  for (const auto& [s, curvature] : joints) {
    const auto after = rod.lower_bound(s);
    const auto before = std::prev(after);
    const double share = (s - before->first) / (after->first - before->first);
    const double expected = before->second + share * (after->second - before->second);
    EXPECT_NEAR(curvature, expected, 2e-3 * std::abs(rod.begin()->second)) << s;
  }
  EXPECT_LT(rod.begin()->second, 0) << "a rod that sinks to the right turns to the right";
}

TEST_F(ReportFolder, EscapesWhatUsersWrite) {
  const std::string name = "<script>alert(1)</script> & \"a\" 'b' `touch made` \n%s {x_1}";
  ReportOptions options = small_report();
  options.history = true;
  (void)write_report(make_report({heavy_file(name)}, options),
                     {.version = "1<2", .command = "dlo \"<b>\""}, folder());
  EXPECT_THAT(page(), AllOf(Not(HasSubstr("<script>alert")), Not(HasSubstr("<b>")),
                            HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;a&quot; "
                                      "&#39;b&#39; `touch made`"),
                            HasSubstr("1&lt;2")));
  EXPECT_FALSE(fs::exists(place() / "report" / "made"));
  EXPECT_THAT(page(), Not(HasSubstr("gnuplot failed")));
}

TEST_F(ReportFolder, NeedsNothingButThePage) {
  (void)write_report(make_report({heavy_file()}, small_report()), {}, folder());
  const std::string html = page();
  EXPECT_THAT(html, AllOf(Not(HasSubstr("src=")), Not(HasSubstr("@import")), Not(HasSubstr("url(")),
                          Not(HasSubstr("fetch(")), Not(HasSubstr("import("))));
  for (std::size_t at = html.find("href="); at != std::string::npos;
       at = html.find("href=", at + 1)) {
    const std::string target = html.substr(at + 6, 5);
    EXPECT_TRUE(target[0] == '#' || target == "data:" || target == "shape" || target == "devia" ||
                target == "budge")
        << target;
  }
}

TEST_F(ReportFolder, HasItsTablesWithoutGnuplot) {
  const Report report = make_report({heavy_file()}, small_report());
  const SearchPath nowhere(place().string());
  const WrittenReport written = write_report(report, {}, folder());
  EXPECT_EQ(written.figures, 0);
  EXPECT_EQ(written.figures_missing, 4);
  EXPECT_THAT(written.why_missing, HasSubstr("gnuplot"));
  const std::string html = page();
  EXPECT_THAT(html, AllOf(Not(HasSubstr("<svg")), HasSubstr("This figure is missing: gnuplot"),
                          HasSubstr("no gnuplot was found")));
  const double rms = report.scenes.front().comparisons.front().deviation.rms_m * 1e3;
  EXPECT_THAT(html, HasSubstr(shown(rms)));
  const std::map<std::string, std::string> files = contents(folder());
  EXPECT_EQ(files.count("shapes_1.csv"), 1U);
  EXPECT_EQ(files.count("shapes_1.gp"), 1U);
  EXPECT_EQ(files.count("shapes_1.svg"), 0U);
}

TEST_F(ReportFolder, KeepsScriptsThatDrawTheSameAgain) {
  const WrittenReport written =
      write_report(make_report({heavy_file()}, small_report()), {}, folder());
  if (written.figures == 0) GTEST_SKIP() << written.why_missing;
  EXPECT_EQ(written.figures_missing, 0);
  const fs::path svg = fs::path(folder()) / "shapes_1.svg";
  const std::string first = text_of(svg);
  fs::remove(svg);
  ASSERT_EQ(std::system(("cd " + folder() + " && gnuplot shapes_1.gp").c_str()), 0);
  EXPECT_EQ(text_of(svg), first);
}

TEST_F(ReportFolder, IsTheSameButForTimes) {
  ReportOptions options = small_report();
  options.map = StabilityMapOptions{.columns = 3, .rows = 4, .steps = 200};
  options.threads = 1;
  (void)write_report(make_report({heavy_file()}, options), {}, folder());
  const std::map<std::string, std::string> first = contents(folder());
  options.threads = 2;
  (void)write_report(make_report({heavy_file()}, options), {}, folder());
  for (const auto& [name, text] : contents(folder())) {
    if (name == "index.html") continue;
    EXPECT_EQ(first.at(name), text) << name;
  }
}

TEST_F(ReportFolder, ReplacesReportsAndNothingElse) {
  const Report report = make_report({heavy_file()}, small_report());
  fs::create_directory(folder());  // an empty one may be used
  (void)write_report(report, {.version = "version one"}, folder());
  (void)write_report(report, {.version = "version two"}, folder() + "/");
  EXPECT_THAT(page(), AllOf(HasSubstr("version two"), Not(HasSubstr("version one"))));

  write("report/mine.txt", "notes");
  expect_refused(folder(), "mine.txt");
  fs::remove(fs::path(folder()) / "mine.txt");
  write("report/scenes/mine.toml", "a scene");
  expect_refused(folder(), "mine.toml");
  write("other/a", "b");
  expect_refused((place() / "other").string(), "holds a");
  expect_refused((place() / "other" / "a").string(), "is a file");
  expect_refused((place() / "none" / "report").string(), "there is no folder");
}

TEST_F(ReportFolder, LeavesNoHalfReports) {
  (void)write_report(make_report({heavy_file()}, small_report()), {}, folder());
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(place())) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, testing::ElementsAre("report"));
}

TEST_F(ReportFolder, TakesNothingFromFoldersOfOthers) {
  write("report." + std::to_string(::getpid()) + ".tmp/stale.txt", "of a report that was stopped");
  const mode_t before = ::umask(027);
  (void)write_report(make_report({heavy_file()}, small_report()), {}, folder());
  ::umask(before);
  EXPECT_EQ(contents(folder()).count("stale.txt"), 0U);
  EXPECT_EQ(fs::status(folder()).permissions(), static_cast<fs::perms>(0750));
  EXPECT_EQ(fs::status(folder() + "/index.html").permissions(), static_cast<fs::perms>(0640));
}

/// What cannot be replaced is refused before anything is computed.
TEST_F(ReportFolder, RefusesPlacesThatCannotBeReplaced) {
  fs::create_directories(place() / "work" / "inner");
  const fs::path before = fs::current_path();
  fs::current_path(place() / "work" / "inner");
  const auto refusal = [](const std::string& to) -> std::string {
    return error_of<InputError>([&] { return check_report_folder(to); });
  };
  for (const char* to : {".", "..", "../../work/", "/"}) {
    EXPECT_THAT(refusal(to), AllOf(HasSubstr("the working directory"), HasSubstr("allowed")));
  }
  EXPECT_EQ(refusal("../inner2"), "no error");
  EXPECT_EQ(refusal("report"), "no error");
  fs::current_path(before);
  EXPECT_THAT(refusal("/proc"), HasSubstr("is where a file system is mounted"));
  EXPECT_THAT(refusal("/proc/report"), HasSubstr("cannot be written"));
  fs::create_directory_symlink(place() / "nowhere", place() / "link");
  EXPECT_THAT(refusal((place() / "link").string()), HasSubstr("a link to nothing"));
  EXPECT_TRUE(fs::is_empty(place() / "work" / "inner"));
}

TEST_F(ReportFolder, SaysWhatDidNotConverge) {
  SceneFile file = heavy_file();
  file.scene.force_model.stepper = Stepper::basic;
  file.scene.force_model.c_F = 1;  // a metre for each newton
  const Report report = make_report({file}, small_report());
  ASSERT_FALSE(report.failures.empty());
  EXPECT_THAT(report.failures.front(), HasSubstr("heavy"));
  (void)write_report(report, {}, folder());
  EXPECT_THAT(page(), HasSubstr("Not computed: heavy"));
}

TEST_F(ReportFolder, PrintsOnlyCommandsThatAreTaken) {
  SceneFile file = heavy_file();
  file.scene.force_model.c_b = 0.1;  // refused with law hooke
  ReportOptions options = small_report();
  options.history = true;
  options.tolerance = 0.02;
  options.quick = true;
  (void)write_report(make_report({file}, options), {}, folder());
  EXPECT_THAT(page(), AllOf(Not(HasSubstr("--law hooke")), HasSubstr("Rows without a command"),
                            HasSubstr("--quick --tolerance 0.02 -o ../again"),
                            HasSubstr("A quick report")));
  file.scene.force_model.c_b.reset();
  (void)write_report(make_report({file}, options), {}, folder());
  EXPECT_THAT(page(), HasSubstr("--law hooke --bookkeeping consistent"));
}

TEST_F(ReportFolder, SaysThatNothingWasRun) {
  ReportOptions options = small_report();
  options.benchmark = BenchmarkOptions{.budget_s = 1e-9, .repeats = 1};
  (void)write_report(make_report({heavy_file()}, options), {}, folder());
  EXPECT_THAT(page(), AllOf(HasSubstr(">not run<"), Not(HasSubstr(">none<")),
                            HasSubstr(": no time is left"), Not(HasSubstr("<tbody>\n</tbody>"))));
}

TEST(Report, SummarisesTheScenesOwnForceModelAndItsWorst) {
  ReportOptions options = small_report();
  options.tolerance = 0.02;
  const Report report = make_report({heavy_file()}, options);
  const std::optional<ReportSummary> summary = report_summary(report);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->count, 1U);
  EXPECT_EQ(summary->right, 0U) << "law paper, as the scene says, not hooke";
  EXPECT_EQ(summary->worst, 0U);
  EXPECT_THAT(summary->main_reason, HasSubstr("of the deviation"));
  options.tolerance = 0.5;
  EXPECT_EQ(report_summary(make_report({heavy_file()}, options))->right, 1U);
  EXPECT_FALSE(report_summary(Report{}));
}

TEST(Report, PutsTheVerdictInNumbers) {
  ReportOptions options = small_report();
  const std::vector<std::string> verdict = report_verdict(make_report({heavy_file()}, options));
  ASSERT_EQ(verdict.size(), 2U);
  EXPECT_THAT(verdict[0], AllOf(HasSubstr("Law paper, bookkeeping paper: 0 of 1"),
                                HasSubstr("the main reason is the law")));
  EXPECT_THAT(verdict[1], HasSubstr("Law hooke, bookkeeping consistent: 1 of 1"));
  options.tolerance = 0.5;
  EXPECT_THAT(report_verdict(make_report({heavy_file()}, options))[0], HasSubstr("1 of 1"));
  options.tolerance = 0;
  EXPECT_THROW((void)make_report({heavy_file()}, options), std::invalid_argument);
}

TEST(Report, GivesNoModulusThatIsNotIdentifiable) {
  // Between two clamps the shape hardly depends on the stiffness.
  SceneFile file = heavy_file();
  file.scene = test::heavy_scene(1.5, 0);
  file.scene.grippers.push_back(file.scene.grippers.front());
  file.scene.grippers.back().at = 1;
  file.scene.grippers.back().position.x() = 0.8;
  const Report report = make_report({file}, small_report());
  ASSERT_EQ(report.scenes.front().comparisons.size(), 1U);
  ASSERT_NE(report.scenes.front().comparisons.front().effective_modulus.optimum, Optimum::clear);
  EXPECT_THAT(report_verdict(report).front(), HasSubstr("E*/E at rest not identified in any"));
}

TEST(Report, TakesASceneThatIsHookeanOnce) {
  SceneFile file = heavy_file();
  file.scene.force_model = {.points = 8};
  const Report report = make_report({file}, small_report());
  EXPECT_EQ(report.scenes.front().comparisons.size(), 1U);
}

TEST(Report, ReadsFoldersOfScenes) {
  const std::string folder = std::string(DLO_DATA) + "/scenes";
  std::size_t scenes = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") ++scenes;
  }
  const std::vector<SceneFile> files = load_scene_files({folder, folder + "/cable.toml"});
  ASSERT_EQ(files.size(), scenes + 1);
  const auto cable = std::find_if(files.begin(), files.end(),
                                  [](const SceneFile& file) { return file.name == "cable.toml"; });
  ASSERT_NE(cable, files.end());
  EXPECT_EQ(files.back().name, "cable_2.toml");
  EXPECT_EQ(files.back().text, cable->text);
  EXPECT_EQ(load_scene(folder + "/" + files[1].name).name, files[1].scene.name);
  EXPECT_THROW((void)load_scene_files({std::string(DLO_DATA) + "/shapes"}), InputError);
  EXPECT_THROW((void)load_scene_files({"nowhere.toml"}), InputError);
}

TEST(Report, IsAboutThePaperUnlessToldOtherwise) {
  const std::vector<SceneFile> files = report_scene_files();
  ASSERT_EQ(files.size(), 5U);
  const std::vector<Scene> paper = paper_scenes();
  for (std::size_t i = 0; i < paper.size(); ++i) EXPECT_EQ(files[i].scene.name, paper[i].name);
  EXPECT_NEAR(files[3].scene.gamma(), 10, 0.2);
  EXPECT_FALSE(files[4].scene.planar());
}

TEST(ModulusHistory, FindsWhenARatioIsPassed) {
  std::vector<ModulusAtTime> times;
  for (const double t : {1., 10., 100.}) {
    times.push_back({.time_s = t, .modulus = {.ratio = 10 / t}});
  }
  EXPECT_NEAR(time_at_ratio(times, 1. / 3), 30, 1e-9);  // E*/E = 10 s / t
  EXPECT_TRUE(std::isnan(time_at_ratio(times, 0.01)));
}

}  // namespace
}  // namespace dlo::compare
