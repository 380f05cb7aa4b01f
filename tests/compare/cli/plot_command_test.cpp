#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "command_fixture.hpp"

namespace dlo {
namespace {

using test::RunResult;
using testing::HasSubstr;
using testing::StartsWith;

class PlotCommand : public test::Command {
 protected:
  /// Runs with --plot into an SVG, PNG or PDF, and checks the picture, and that exit status and
  /// standard output are the same as without it.
  void expect_picture(const std::string& arguments, const std::string& file) const {
    const RunResult plain = run(arguments);
    const RunResult drawn = run(arguments + " --plot " + path(file));
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

TEST_F(PlotCommand, EveryCommandDraws) {
  const std::string shape = solved_file(steel() + " --samples 8");
  const std::string sweep = "sweep " + steel() + " --vary gamma=log:0.1:10:3";
  const std::string map = "stability " + steel() + " --columns 2 --rows 3 --map-steps 50 --map ";
  expect_picture("solve " + steel() + " --format csv --samples 5", "solution.pdf");
  expect_picture(sweep, "lines.svg");
  expect_picture(sweep + " --vary rod.length=lin:0.4:0.6:7", "map.png");
  expect_picture(map + "cF-cc", "c_c.svg");
  expect_picture(map + "cF-ch", "c_h.png");
  // Most of these commands print times, so that only their pictures are tested.
  const std::string scenes = steel() + " " + DLO_DATA + "/scenes/spring_steel_135.toml";
  const std::pair<std::string, std::string> commands[] = {
      {"compare --no-modulus " + scenes, "135"},
      {"calibrate " + steel() + " --noise '1 mm' --shape " + shape, "95 % interval"},
      {"bench " + steel() + " --seconds 1 --repeats 1", "</svg>"},
      {"sweep " + steel() + " --vary gamma=1,2 -o " + path("s.csv"), "</svg>"}};
  for (const auto& [command, words] : commands) {
    succeeds(command + " --plot " + path("a.svg"));
    expect_drawn("a.svg");
    EXPECT_THAT(read(path("a.svg")), HasSubstr(words)) << command;
  }
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
    const std::string drawn = output_of("solve " + scene(key + rest) + " --plot " + path("n.svg"));
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
  const std::string mine = solved_file(steel() + " --model chain --law hooke");
  const std::string check = "check " + steel() + " --no-modulus --shape " + mine + " --format csv";
  expect_picture(check, "a.svg");
  const RunResult failed =
      run(check + " --no-explanation --tolerance 0.0001% --plot " + path("b.png"));
  EXPECT_EQ(failed.status, 1);
  expect_drawn("b.png");
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
  EXPECT_THAT(page, HasSubstr("largest part: law"));
  EXPECT_THAT(page, HasSubstr("a&lt;b&gt;"));
  EXPECT_TRUE(test::has_none(page, {"<script", "a<b>", "src=\"http", "href=\"http", "url("}));
  EXPECT_THAT(page, HasSubstr("<svg role=\"img\""));
  expect_error(command + " --report " + gentle, 2, {"is read too"});
}

TEST_F(PlotCommand, RefusesBeforeItComputes) {
  const std::string solve = "solve " + steel() + " --plot ";
  expect_error(solve + path("a.jpg"), 2, {"a.jpg", "allowed", ".svg", ".png", ".pdf"});
  expect_error(solve + path("none/a.svg"), 2, {"none/a.svg"});
  expect_error(solve + path("a.svg") + " -o " + path("a.svg"), 2, {"written twice"});
  expect_error(solve + "-", 2, {"--plot -", "allowed", ".svg"});
  EXPECT_FALSE(std::filesystem::exists(path("a.jpg")));
  const std::string plot = " --plot " + path("a.svg");
  expect_error("calibrate " + steel() + plot, 2, {"--plot", "--shape"});
  expect_error("stability --case folded" + plot, 2, {"--plot", "--map"});
  const std::string sweep = "sweep " + steel() + " --vary gamma=1";
  expect_error(sweep + " --vary rod.length=1 --vary gripper.0.at=0" + plot, 2,
               {"--plot", "3 fields", "allowed: one or two"});
  expect_error(sweep + " --part 1/2" + plot, 2, {"--plot", "--part 1/2", "allowed"});
}

TEST_F(PlotCommand, WithoutGnuplotSaysWhatIsMissingAndWritesNothing) {
  const RunResult result = run_line("PATH=/nowhere " + std::string(DLO_COMMAND) + " solve " +
                                    steel() + " --plot " + path("a.svg"));
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("needs the program gnuplot"));
  EXPECT_FALSE(std::filesystem::exists(path("a.svg")));
}

}  // namespace
}  // namespace dlo
