#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "command_fixture.hpp"

namespace dlo {
namespace {

using test::Outcome;
using testing::HasSubstr;
using testing::StartsWith;

class PlotCommand : public test::Command {
 protected:
  /// Runs with --plot into an SVG or PNG, and checks that standard output is the same as without
  /// it.
  void expect_picture(const std::string& arguments, const std::string& file) const {
    const Outcome plain = run(arguments);
    const Outcome drawn = run(arguments + " --plot " + path(file));
    EXPECT_EQ(drawn.status, plain.status) << drawn.err;
    EXPECT_EQ(drawn.out, plain.out) << arguments;
    expect_drawn(file);
  }
  void expect_drawn(const std::string& file) const {
    const std::string picture = read(path(file));
    if (file.ends_with(".svg")) {
      EXPECT_THAT(picture, HasSubstr("</svg>")) << file;
    } else if (file.ends_with(".png")) {
      EXPECT_THAT(picture, StartsWith("\x89PNG")) << file;
    } else {
      EXPECT_THAT(picture, StartsWith("%PDF")) << file;
    }
    EXPECT_GT(picture.size(), 2000U) << file;
  }
  void SetUp() override {
    Command::SetUp();
    if (run_line("gnuplot --version").status != 0) GTEST_SKIP() << "there is no gnuplot";
  }
};

TEST_F(PlotCommand, SolveDraws) {
  const std::string solve = "solve " + steel() + " --format csv --samples 5";
  expect_picture(solve, "a.svg");
  expect_picture(solve, "a.png");
  expect_picture(solve, "a.pdf");
}

TEST_F(PlotCommand, DrawsASceneOfAnyName) {
  const std::string rest =
      "[rod]\nlength = 0.4\ndiameter = 0.003\nmaterial = \"silicone\"\n"
      "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = 0\n";
  constexpr std::pair<const char*, const char*> names[] = {
      {"'round", ">'round<"},
      {"a''b", ">a''b<"},
      {"'\\\"`id`", ">'\\\"`id`<"},
      {"x]]>y", ">x]]\xe2\x80\x8b>y<"},
      {"n\\uFFFF\\uFFFEm", ">n\xef\xbf\xbd\xef\xbf\xbdm<"},
      {"e\\u001b[7mf", ">e [7mf<"}};
  for (const auto& [name, shown] : names) {
    std::string key = std::string("name = \"") + name + "\"\n";
    if (std::string_view(name).starts_with("'\\")) {
      key = std::string("name = '''\n") + name + "'''\n";
    }
    const std::string drawn = said("solve " + scene(key + rest) + " --plot " + path("n.svg"));
    std::string picture = read(path("n.svg"));
    for (const std::string around : {"<![CDATA[", "]]>"}) {
      // Removes the delimiters of CDATA sections.
      for (std::size_t at = 0; (at = picture.find(around, at)) != std::string::npos;) {
        picture.erase(at, around.size());
      }
    }
    EXPECT_THAT(picture, HasSubstr(shown)) << name;
  }
}

TEST_F(PlotCommand, CheckDrawsAndKeepsItsVerdict) {
  succeeds("solve " + steel() + " --model chain --law hooke --format csv -o " + path("mine.csv"));
  const std::string check =
      "check " + steel() + " --no-modulus --shape " + path("mine.csv") + " --format csv";
  expect_picture(check, "a.svg");
  const Outcome failed =
      run(check + " --no-explanation --tolerance 0.0001% --plot " + path("b.png"));
  EXPECT_EQ(failed.status, 1);
  expect_drawn("b.png");
}

TEST_F(PlotCommand, CompareDrawsEachScene) {
  const std::string other = std::string(DLO_DATA) + "/scenes/spring_steel_135.toml";
  for (const char* file : {"a.svg", "a.png"}) {
    const std::string drawn =
        said("compare --no-modulus " + steel() + " " + other + " --plot " + path(file));
    expect_drawn(file);
  }
  EXPECT_THAT(read(path("a.svg")), HasSubstr("135"));
}

TEST_F(PlotCommand, CompareReportsEachScene) {
  const std::string gentle = scene(
      "name = \"a<b>\"\n[rod]\nlength = 0.2\nbending_stiffness = 0.1\nmass_per_length = 0.01\n"
      "[force_model]\nlaw = \"hooke\"\nbookkeeping = \"consistent\"\n"
      "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = 0\n");
  const std::string command = "compare " + steel() + " " + gentle;
  succeeds(command + " --report " + path("both.html"));
  const std::string page = read(path("both.html"));
  EXPECT_THAT(page, HasSubstr("<p class=\"badge fail\">"));
  EXPECT_THAT(page, HasSubstr("<p class=\"badge pass\">"));
  EXPECT_THAT(page, HasSubstr("Largest part of the deviation: law"));
  EXPECT_THAT(page, HasSubstr("a&lt;b&gt;"));
  EXPECT_TRUE(test::says_none(page, {"<script", "a<b>", "src=\"http", "href=\"http", "url("}));
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("<svg role=\"img\"", at)) != std::string::npos; ++at) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 8U);
  expect_error(command + " --report " + gentle, 2, {"is read too"});
}

TEST_F(PlotCommand, CalibrateDraws) {
  succeeds("solve " + steel() + " --samples 8 --format csv -o " + path("s.csv"));
  for (const char* file : {"a.svg", "a.png"}) {
    const std::string drawn = said("calibrate " + steel() + " --noise '1 mm' --shape " +
                                   path("s.csv") + " --plot " + path(file));
    expect_drawn(file);
  }
  EXPECT_THAT(read(path("a.svg")), HasSubstr("95 % interval"));
  expect_error("calibrate " + steel() + " --plot " + path("c.svg"), 2, {"--plot", "--shape"});
}

TEST_F(PlotCommand, BenchDraws) {
  for (const char* file : {"a.svg", "a.png"}) {
    const std::string drawn =
        said("bench " + steel() + " --seconds 1 --repeats 1 --plot " + path(file));
    expect_drawn(file);
  }
}

TEST_F(PlotCommand, SweepDrawsLinesAndMaps) {
  const std::string sweep = "sweep " + steel();
  expect_picture(sweep + " --vary gamma=log:0.1:10:3", "a.svg");
  expect_picture(sweep + " --vary gamma=log:0.1:10:3 --vary rod.length=lin:0.4:0.6:7", "b.png");
  const std::string filed =
      said(sweep + " --vary gamma=1,2 -o " + path("s.csv") + " --plot " + path("c.svg"));
  expect_drawn("c.svg");
  expect_error(
      sweep + " --vary gamma=1 --vary rod.length=1 --vary gripper.0.at=0 --plot " + path("d.svg"),
      2, {"--plot", "3 fields", "allowed: one or two"});
  expect_error(sweep + " --vary gamma=1 --part 1/2 --plot " + path("d.svg"), 2,
               {"--plot", "--part 1/2", "allowed"});
}

TEST_F(PlotCommand, StabilityDrawsItsMap) {
  const std::string map = "stability " + steel() + " --columns 2 --rows 3 --map-steps 50 --map ";
  expect_picture(map + "cF-cc", "a.svg");
  expect_picture(map + "cF-ch", "a.png");
  expect_error("stability --case folded --plot " + path("b.svg"), 2, {"--plot", "--map"});
}

TEST_F(PlotCommand, RefusesBeforeItComputes) {
  const std::string solve = "solve " + steel() + " --plot ";
  expect_error(solve + path("a.jpg"), 2, {"a.jpg", "allowed", ".svg", ".png", ".pdf"});
  expect_error(solve + path("none/a.svg"), 2, {"none/a.svg"});
  expect_error(solve + path("a.svg") + " -o " + path("a.svg"), 2, {"written twice"});
  expect_error(solve + "-", 2, {"--plot -", "allowed", ".svg"});
  EXPECT_FALSE(std::filesystem::exists(path("a.jpg")));
}

TEST_F(PlotCommand, WithoutGnuplotSaysWhatIsMissingAndWritesNothing) {
  const Outcome result = run_line("PATH=/nowhere " + std::string(DLO_COMMAND) + " solve " +
                                  steel() + " --plot " + path("a.svg"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("needs the program gnuplot"));
  EXPECT_FALSE(std::filesystem::exists(path("a.svg")));
}

}  // namespace
}  // namespace dlo
