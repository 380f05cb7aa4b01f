// Tests of the command `dlo suite`: score cards of simulators with deliberate errors.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "base/output_file.hpp"
#include "batch/baseline.hpp"
#include "command_fixture.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

using testing::HasSubstr;

class SuiteCommand : public PythonCommand {
 protected:
  /// Returns the option --with that runs simulator.py with this defect.
  static std::string simulator_with_defect(const std::string& defect) {
    return with_program(defect, "tests/compare/suite/simulator.py " + defect);
  }
  [[nodiscard]] json card_of(const std::string& arguments) const {
    return json_of("suite " + arguments).at("cards").at(0);
  }
  static std::set<std::string> causes(const json& card) {
    std::set<std::string> names;
    for (const json& scene : card.at("scenes")) {
      for (const json& cause : scene.at("causes")) names.insert(cause.at("name"));
    }
    return names;
  }
};

constexpr const char* few = " --scenes bending_large,weight_1,weight_10,payload_tip,floor";

using Names = std::set<std::string>;

TEST_F(SuiteCommand, FindsNoCauseInWhatIsRight) {
  for (const char* defect : {"right", "middle"}) {
    const json card = card_of(simulator_with_defect(defect) + few);
    EXPECT_EQ(causes(card), Names()) << card.dump(1);
    EXPECT_EQ(card.at("total").at("right"), 4) << defect;
    // The only unsupported scene has a floor, which this simulator does not model.
    EXPECT_EQ(card.at("total").at("not_supported"), 1) << defect;
    EXPECT_GT(card.at("total").at("smallest_order"), 1.7) << defect;
  }
}

TEST_F(SuiteCommand, NamesWhatIsWrong) {
  const std::tuple<const char*, const char*, int> defects[] = {
      {"linear", "springs linear in the angle", 2},
      {"welded", "first element welded", 0},
      {"hinge", "hinge at the clamp", 0},
      {"soft", "bending stiffness wrong", 0},
      {"no_h", "springs without 1/h", 0}};
  for (const auto& [defect, name, right] : defects) {
    const json card = card_of(simulator_with_defect(defect) + " --scenes bending_large,weight_10");
    EXPECT_EQ(causes(card), Names{name}) << card.dump(1);
    EXPECT_EQ(card.at("total").at("right"), right) << defect;
  }
}

TEST_F(SuiteCommand, HasOurPolygonsWithThePapersLawToo) {
  for (const std::string model : {"chain", "force"}) {
    const std::string same = " --with same='" + std::string(DLO_COMMAND) + " solve " + DLO_DATA +
                             "/suite/scenes/weight_10.toml --law paper --points {points} --model " +
                             model + " --format csv -o {shape}'";
    const json cards = json_of("suite --points 8 --scenes weight_10 --with " + model +
                               "_paper --with " + model + same)
                           .at("cards");
    const auto error = [&](std::size_t card, std::size_t run) {
      return cards.at(card).at("scenes").at(0).at("runs").at(run).at("rms_over_length");
    };
    for (const std::size_t run : {0, 1, 2}) {
      EXPECT_NEAR(error(0, run), error(2, run), 1e-6) << model;
      EXPECT_GT(error(0, run).get<double>(), 5 * error(1, run).get<double>()) << model;
    }
  }
  // The paper's law M = 2 c_b L sin^3(angle / 2): the cause is the power of the angle, with one
  // clamp and with two.
  const json cubic = card_of("--points 8 --with chain_paper --scenes weight_1,clamps_step");
  EXPECT_EQ(causes(cubic), Names{"springs with a power of the angle"}) << cubic.dump(1);
  for (const json& scene : cubic.at("scenes")) {
    EXPECT_NEAR(scene.at("causes").at(0).at("factor"), 3, 0.01);
  }
}

TEST_F(SuiteCommand, NamesWhatIsNotAtRestThoughTipLoadsMakeItAStifferRod) {
  const json card = card_of(simulator_with_defect("not_at_rest") +
                            " --scenes bending_small,weight_1,weight_10,buckling_weight");
  EXPECT_EQ(causes(card), Names{"not at rest"}) << card.dump(1);
  EXPECT_GE(card.at("total").at("causes").at("not at rest"), 2) << card.dump(1);
}

TEST_F(SuiteCommand, TellsTheFactorOfACause) {
  const json soft = card_of(simulator_with_defect("soft") + " --scenes weight_10");
  EXPECT_NEAR(soft.at("scenes").at(0).at("causes").at(0).at("factor"), 0.7, 0.01);
  const json light = card_of(simulator_with_defect("light") + " --scenes payload_tip");
  const json& cause = light.at("scenes").at(0).at("causes").at(0);
  EXPECT_EQ(cause.at("name"), "weight wrong");
  EXPECT_NEAR(cause.at("factor"), 0.8, 0.01);
  EXPECT_EQ(causes(card_of(simulator_with_defect("weightless") + " --scenes weight_1,payload_tip")),
            Names{"weight ignored"});
}

TEST_F(SuiteCommand, IsTheSameWithOneJobAndTwo) {
  const auto without_times = [](json card) {
    for (json& group : card["classes"]) group.erase("wall_s");
    card["total"].erase("wall_s");
    for (json& scene : card["scenes"]) {
      for (json& one : scene["runs"]) one.erase("wall_s");
    }
    return card;
  };
  const std::string scenes = "--with chain --scenes weight,twist --jobs ";
  EXPECT_EQ(without_times(card_of(scenes + "1")), without_times(card_of(scenes + "2")));
}

TEST_F(SuiteCommand, AFailureIsNoMissingSupport) {
  // A simulator that ends with an error, crashes, hangs or cannot be started.
  const std::string suite = "suite --scenes weight_1 --time-limit 0.2 --with mine=";
  for (const char* program : {"'sh -c \"exit 2\" {shape}'", "'sh -c \"kill -SEGV \\$\\$\" {shape}'",
                              "'sleep 9 {shape}'", "'/no/such/program {shape}'"}) {
    EXPECT_EQ(json_of(suite + program, 3).at("cards").at(0).at("total").at("failed"), 1) << program;
  }
  const json quiet =
      card_of(" --scenes weight_1 --with mine='sh -c \"echo not supported: weight >&2\" {shape}'");
  EXPECT_EQ(quiet.at("total").at("not_supported"), 1);
}

TEST_F(SuiteCommand, RunsAgainOnlyWhatFailedAndWhatHasChanged) {
  const std::string count = "echo run >> " + path("runs") + "\n";
  const auto runs = [&] {
    const std::string text = read(path("runs"));
    return std::count(text.begin(), text.end(), '\n');
  };
  const std::string suite = "suite --scenes weight_1 --state " + path("state") +
                            " --with mine='sh " + path("mine.sh") + " {shape}'";
  std::ofstream(path("mine.sh")) << count << "exit 1\n";
  EXPECT_EQ(run(suite).status, 3);
  EXPECT_EQ(run(suite).status, 3);
  EXPECT_EQ(runs(), 6);  // three numbers of points
  std::ofstream(path("mine.sh")) << count << "echo not supported: this >&2\n";
  EXPECT_EQ(run(suite).status, 0);
  EXPECT_EQ(run(suite).status, 0);
  EXPECT_EQ(runs(), 7);
  EXPECT_EQ(run(suite + " --time-limit 7").status, 0);
  EXPECT_EQ(runs(), 8);
  std::ofstream(path("mine.sh"), std::ios::app) << "\n";
  const json first = card_of(suite.substr(6));
  EXPECT_EQ(runs(), 9);
  EXPECT_EQ(card_of(suite.substr(6)), first);
  EXPECT_EQ(runs(), 9);
}

TEST_F(SuiteCommand, ASignalEndsAllSimulators) {
  // Each simulator leaves a file when it runs, and then waits for longer than the test.
  const std::string program = "sh -c \"touch " + path("started_$$") + "; exec sleep 987\" {shape}";
  const std::string two_run =
      "for i in $(seq 200); do [ $(ls " + path("") + " | grep -c started_) -ge 2 ] && break; ";
  const RunResult outcome = run_line(
      std::string(DLO_COMMAND) + " suite --jobs 2 --scenes weight --with mine='" + program +
      "' & " + two_run +
      "sleep 0.02; done; kill -TERM $!; wait $!; echo $?; for i in $(seq 200); do pgrep -x -f "
      "'sleep 987' > /dev/null || break; sleep 0.02; done; pgrep -c -x -f 'sleep 987'");
  EXPECT_EQ(outcome.out, "143\n0\n");
}

TEST_F(SuiteCommand, AReferenceThatDoesNotConvergeIsAnEntry) {
  std::ofstream(path("good.toml")) << steel_rod + level_clamp;
  // A payload that bends the rod within less than the terms of the reference resolve.
  std::ofstream(path("bad.toml")) << steel_rod + level_clamp + "[[load]]\nat = 0.5\nmass = 1e28\n";
  std::ofstream(path("battery.toml"))
      << "schema = \"dlo/suite/1\"\nversion = \"1\"\n"
         "[[scene]]\nfile = \"good.toml\"\nclass = \"a|b\"\nisolates = \"x\"\n"
         "[[scene]]\nfile = \"bad.toml\"\nclass = \"a|b\"\nisolates = \"x\"\n";
  const std::string suite = "suite --with chain --battery " + path("battery.toml");
  const json card = json_of(suite + " --markdown " + path("card.md"), 3).at("cards").at(0);
  EXPECT_EQ(card.at("total").at("right"), 1);
  EXPECT_EQ(card.at("total").at("not_judged"), 1);
  EXPECT_EQ(card.at("scenes").at(1).at("status"), "not judged");
  EXPECT_THAT(read(path("card.md")), HasSubstr("| a\\|b | 1 of 2 |"));
}

TEST_F(SuiteCommand, ReplacesNoFileOfAnother) {
  const std::string write = "suite --scenes bending_large --write " + path("pack");
  succeeds(write);
  succeeds(write);
  for (const char* name : {"bending_large.csv", "suite.json"}) {
    std::filesystem::remove_all(path("pack"));
    std::filesystem::create_directory(path("pack"));
    std::ofstream(path("pack") + "/" + name) << "mine";
    expect_output(write, 2, {std::string(name) + ": not written by an earlier dlo suite"});
    EXPECT_EQ(read(path("pack") + "/" + name), "mine");
  }
}

TEST_F(SuiteCommand, ABaselineWithNothingToCompareIsAnError) {
  const std::string gate = " --baseline " + path("errors.toml");
  succeeds("suite --with chain --scenes weight_1" + gate + " --update");
  // The force model does not support any scene of the class `motion`.
  expect_output("suite --with force --scenes motion" + gate, 2,
                {"nothing to compare with the baseline"});
}

TEST_F(SuiteCommand, HoldsErrorsAgainstABaselineOfRegress) {
  const std::string scenes = " --scenes weight_1,strip_flat ";
  const std::string file = path("errors.toml");
  const std::string gate = " --baseline " + file;
  succeeds("suite --with chain --with force" + scenes + gate + " --update");
  expect_output("suite --with chain" + scenes + gate, 0,
                {"\n3 same\n"});  // a strip is not supported
  // The errors of one simulator in the baseline are divided by ten, so that its errors now have
  // increased.
  std::vector<BaselineCase> cases = load_baseline(file);
  ASSERT_EQ(cases.size(), 6U);
  for (BaselineCase& one : cases) {
    if (one.program == "chain") one.errors.rms /= 10;
  }
  write_file(file, baseline_text(cases));
  expect_output("suite --with chain" + scenes + gate, 1,
                {"worse                weight_1 (chain, N = 16)"});
  // An update keeps the cases of other simulators.
  succeeds("suite --with chain" + scenes + gate + " --update");
  EXPECT_EQ(load_baseline(file).size(), 6U);
  EXPECT_EQ(run("suite --with force" + scenes + gate).status, 0);
  EXPECT_EQ(run("suite --with chain --scenes bending" + gate).status, 1);  // not in the baseline
  std::ofstream(file) << "{}";
  EXPECT_EQ(run("suite --with chain" + scenes + gate).status, 2);
}

TEST_F(SuiteCommand, WritesTheCardInEachForm) {
  EXPECT_THAT(
      output_of("suite --with chain --scenes weight_1,strip_flat --markdown " + path("card.md") +
                " --junit " + path("card.xml") + " --report " + path("card.html")),
      HasSubstr("chain: 1 of 2 scenes right, 1 not supported"));
  EXPECT_THAT(read(path("card.md")), HasSubstr("| weight | 1 of 1 |"));
  const std::string xml = read(path("card.xml"));
  EXPECT_THAT(xml, HasSubstr("tests=\"2\" failures=\"0\" errors=\"0\" skipped=\"1\""));
  EXPECT_EQ(std::system(("xmllint --noout " + path("card.xml")).c_str()), 0);
  const std::string page = read(path("card.html"));
  EXPECT_THAT(page, HasSubstr("<p class=\"badge pass\">\u2713 chain: 1 of 2 scenes right"));
  EXPECT_THAT(page, HasSubstr("weight"));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  if (run_line("gnuplot --version").status == 0) EXPECT_THAT(page, HasSubstr("<svg role=\"img\""));
}

TEST_F(SuiteCommand, TellsWhatItIsAskedWrongly) {
  EXPECT_EQ(run("suite").status, 2);
  expect_error("suite --with chain --scenes wieght", 2, {"did you mean weight"});
  expect_error("suite --with energy", 2, {"NAME=COMMAND"});
  expect_error("suite --with chain --with chain", 2, {"given twice"});
}

}  // namespace
}  // namespace dlo::compare
