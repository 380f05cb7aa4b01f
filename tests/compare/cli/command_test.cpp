// Tests of the command `dlo`: exit status, standard output, standard error and files.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "command/commands.hpp"
#include "command_fixture.hpp"
#include "option/effect.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

const std::string good = steel_rod + gripper_text("direction = \"-175 deg\"");

TEST_F(Command, CompareWritesTheContractsJson) {
  const json document = json_of("compare " + steel() + " " + scene(good));
  EXPECT_EQ(document.at("schema"), "dlo/compare/1");
  ASSERT_EQ(document.at("cases").size(), 2U);
  const json& paper = document.at("cases")[0];
  EXPECT_NEAR(paper.at("parameters").at("c_b"), 3574.96, 0.005);
  EXPECT_NEAR(paper.at("effective_modulus_ratio"), 0.044, 0.001);
  for (const char* key : {"rms_m", "max_m", "tip_m", "rms_over_length"}) {
    EXPECT_GT(paper.at("deviation").at(key).get<double>(), 0) << key;
  }
  EXPECT_GT(paper.at("cost").at("force_s").get<double>(), 0);
  EXPECT_EQ(document.at("cases")[1].at("law"), "hooke");
}

TEST_F(Command, PaperHasTheSameNumbersInJsonAndInCsv) {
  succeeds("paper --format json -o " + path("paper.json"));
  const json document = json::parse(read(path("paper.json")));
  EXPECT_EQ(document.at("schema"), "dlo/paper/1");
  const std::vector<test::CsvRow> rows = csv_rows(output_of("paper --format csv"));
  ASSERT_GT(rows.size(), 1000U);
  for (const test::CsvRow& row : std::span(rows).subspan(1)) {
    const json& value = document.at(json::json_pointer("/" + row.at(0)));
    if (!value.is_number() || row[0].find("/cost/") != std::string::npos) continue;
    EXPECT_NEAR(std::stod(row.at(1)), value, 1e-10 * std::abs(value.get<double>())) << row[0];
  }
  ASSERT_EQ(document.at("cases").size(), 6U);
  EXPECT_NEAR(document.at("cases")[0].at("effective_modulus_ratio"), 0.0285, 0.5001e-4);
  const json& moving = document.at("moving");
  // The rows are the eleven experiments of Tables 2 to 4, and their five movements with three more
  // steppers each.
  ASSERT_EQ(moving.at("rows").size(), 26U);
  // The average forces of Tables 2 and 4 are met within 10 % RMS with c_F and l_s in centimetres.
  const auto scanned = [&](int row, const char* key) { return moving.at("scan")[row].at(key); };
  EXPECT_EQ(scanned(0, "choices").at("length_unit_m"), 0.01);
  EXPECT_LT(scanned(0, "distance").at("force_factor").get<double>(), 1.1);
  EXPECT_GT(scanned(0, "distance").at("force_factor").get<double>(), 1);
  EXPECT_EQ(scanned(1, "choices").at("length_unit_m"), 1);
  EXPECT_TRUE(scanned(1, "distance").at("force_factor").is_null());
}

TEST_F(Command, StabilityWritesTheContractsJsonAndFailsForNothingButAutoAndImplicit) {
  const json document = json_of("stability --case crossed --max-steps 2000");
  EXPECT_EQ(document.at("schema"), "dlo/stability/1");
  ASSERT_EQ(document.at("cases").size(), 7U);
  const json& last = document.at("cases")[4];
  EXPECT_EQ(last.at("case"), "points crossed");
  EXPECT_EQ(last.at("stepper"), "auto");
  EXPECT_EQ(last.at("outcome"), "pass");
  EXPECT_LT(last.at("error_over_length").get<double>(), 1e-5);
  EXPECT_GT(last.at("steps").get<long>(), 100);
  EXPECT_EQ(document.at("cases")[6].at("stepper"), "implicit");
  EXPECT_EQ(document.at("cases")[6].at("outcome"), "pass");
  EXPECT_LT(document.at("cases")[6].at("steps").get<long>(), 100);
  EXPECT_EQ(run("stability --case crossed --stepper auto --max-steps-auto 100").status, 1);
  const RunResult refused = run("stability --case \"pulled too far\" --stepper auto");
  const RunResult no_number =
      run("stability --case \"pulled too far\" --stepper auto --format csv");
  EXPECT_TRUE(has_all(no_number.out, {"\npulled too far,auto,refused,0,,false,"}));
  EXPECT_EQ(refused.status, 0);
  EXPECT_TRUE(has_all(refused.out, {"no more than the 0.5 m of rod"}));
}

TEST_F(Command, StabilityMapTakesAScene) {
  const std::string small = " --columns 2 --rows 8 --map-steps 2000";
  const RunResult csv = run("stability " + scene(good) + " --map cF-cc --format csv" + small);
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 1 + 2 * 8) << csv.err;
  const json document = json_of("stability --map cF-cc" + small);
  EXPECT_EQ(document.at("schema"), "dlo/stability-map/1");
  EXPECT_GE(document.at("columns")[0].at("c_F_measured").get<double>(),
            document.at("columns")[0].at("c_F_predicted").get<double>());
  expect_error("stability --map cF-l_s", 2, {"cF-l_s", "cF-cc"});
  expect_error("stability " + scene(good), 2, {"SCENE", "--map"});
  expect_error("stability --case nonsense", 2, {"nonsense"});
}

TEST_F(Command, BenchWritesRowsAndAnswers) {
  const std::string arguments = "bench " + steel() + " --seconds 0.5 --repeats 1";
  const json document = json_of(arguments);
  EXPECT_EQ(document.at("schema"), "dlo/bench/2");
  // The number of runs within half a second depends on the machine; the other runs are listed as
  // skipped.
  EXPECT_GT(document.at("runs").size() + document.at("skipped").size(), 5U);
  for (const json& row : document.at("runs")) {
    for (const char* key :
         {"scene", "model", "law", "size", "time_s", "evaluations", "rms_over_length", "front"}) {
      EXPECT_TRUE(row.contains(key)) << key;
    }
  }
  EXPECT_EQ(document.at("answers")[0].at("static").size(), 4U);
  expect_error("bench --seconds 0", 2, {"--seconds"});
  expect_error("bench " + path("missing.toml"), 2, {"missing.toml"});
}

TEST_F(Command, BadUsageIsOneLineAndStatusTwo) {
  expect_error("solve", 2, {"SCENE"});
  expect_error("solve " + steel() + " --model fem", 2, {"fem", "energy"});
  expect_error("solve " + steel() + " --points 1", 2, {"--points"});
  expect_error("solve " + steel() + " --format xml", 2, {"xml", "json"});
}

TEST_F(Command, WhatDoesNotConvergeIsStatusThreeAndLeavesTheOldFile) {
  const std::string output = write("result.json", "old");
  const auto expect_status_three = [&](const std::string& options,
                                       const std::vector<std::string>& words) {
    expect_error("solve " + steel() + " -o " + output + options, 3, words);
    EXPECT_EQ(read(output), "old") << options;
  };
  expect_status_three(" --max-evaluations 1", {"energy model", "evaluation limit"});
  expect_status_three(" --model chain --max-evaluations 1", {"chain"});
  expect_status_three(" --model force --max-steps 5", {"force model", "5 steps"});
  expect_status_three(" --model force --stepper basic --c-F 1", {"diverged"});
}

TEST_F(Command, TheExtensionIsTheFormatUnlessOneIsGiven) {
  const auto first_line = [&](const std::string& arguments, const std::string& file) {
    succeeds(arguments + " -o " + path(file));
    const std::string text = read(path(file));
    return text.substr(0, text.find('\n'));
  };
  const std::string solve = "solve " + steel();
  EXPECT_EQ(first_line(solve, "a.csv"), "x,y,z,s");
  EXPECT_EQ(first_line(solve, "a.json"), "{");
  EXPECT_EQ(first_line(solve, "a.vtk").substr(0, 5), "# vtk");
  EXPECT_EQ(first_line(solve, "a.txt").substr(0, 5), "scene");
  EXPECT_EQ(first_line(solve + " --format json", "b.csv"), "{");
  EXPECT_EQ(first_line("compare " + steel(), "c.csv").substr(0, 6), "scene,");
  EXPECT_EQ(first_line("calibrate " + steel(), "c.json"), "{");
}

/// Returns words that give an option, with a value that the option takes, or the option alone if
/// the list has no value for it. For SCENE it returns a file name.
std::string with_value(const std::string& option) {
  static const std::string examples =
      "--arc-lengths file --unit mm --segments 8 --shape a.csv --motion a.csv "
      "--parameters a.toml --points 12 --law hooke --bookkeeping paper --stepper dynamic "
      "--bending-rule moment_matched --design-curvature 5 --c-b 1 --c-c 1 --c-F 1 --c-h 0.5 "
      "--l-s 1 --max-steps 9 --rest-tolerance 1e-5 --target-error 1% --terms 9 "
      "--step-rate 1000 --every 2 --samples 9 --case folded --max-steps-auto 9 "
      "--steps-at-rest 9 --map cF-cc --columns 2 --rows 4 --map-steps 9 --time-limit 1 "
      "--state d --baseline a.json --markdown a.md --junit a.xml --report a.html "
      "--output a.json --relative 1% --absolute 1% ";
  if (option == "SCENE") return "scene.toml";
  const std::size_t at = examples.find(option + " ");
  if (at == std::string::npos) return option;
  return examples.substr(at, examples.find(' ', at + option.size() + 1) - at);
}

/// Returns the words of a command with which all conditions of a row hold.
std::string with_conditions(const std::string& command, const cli::IneffectiveOptions& row,
                            const std::string& scene) {
  const std::map<std::string, std::string> arguments = {
      {"regress", scene + " --baseline b.toml"}, {"suite", "--write d"}, {"stability", ""}};
  const auto own = arguments.find(command);
  std::string line = command + " " + (own == arguments.end() ? scene : own->second);
  for (const cli::OptionCondition& condition : row.conditions) {
    if (condition.values.empty()) continue;
    const std::string& value = condition.values.front();
    const bool has_example = value == cli::any_value || value == cli::whole_number;
    line += " " + (has_example ? with_value(condition.option) : condition.option + " " + value);
  }
  return line;
}

TEST_F(Command, EveryOptionWithoutEffectIsRefusedOrReported) {
  int refused = 0;
  int stated = 0;
  std::vector<std::pair<std::string, cli::IneffectiveOptions>> rows;
  for (const cli::NamedCommand& command : cli::all_commands) {
    const std::string name(command.name);
    for (auto& row : cli::ineffective_options(name)) rows.emplace_back(name, std::move(row));
  }
  for (const auto& [command, row] : rows) {
    const std::string line = with_conditions(command, row, steel());
    for (const std::string& option : row.options) {
      const std::string all = option == "--format" ? line : line + " " + with_value(option);
      const std::vector<std::string> words = {
          option, option == "--format" ? "not available" : "no effect", "(allowed: " + row.allowed};
      if (row.response == cli::NoEffect::refused) {
        expect_error(all, 2, words);
        ++refused;
      } else {
        const RunResult outcome = run(all);
        if (outcome.status == 2) continue;  // the value is an error of its own
        EXPECT_TRUE(has_all(outcome.err, words)) << all;
        ++stated;
      }
    }
  }
  EXPECT_GT(refused, 80);
  EXPECT_GT(stated, 6);
  const std::string curvature = " --model force --design-curvature 5";
  expect_error("solve " + steel() + curvature + " --law hooke", 2,
               {"--design-curvature: no effect with law hooke (allowed: --law paper)"});
  EXPECT_EQ(run("solve " + steel() + curvature + " --law paper").err, "");
}

TEST_F(Command, HelpIsACommandAndUnknownOptionsAreNamed) {
  EXPECT_EQ(run("help solve").out, run("solve --help").out);
  expect_error("help nothing", 2, {"unknown command nothing"});
  expect_error("-V", 2, {"unknown option -V", "--version"});
}

}  // namespace
}  // namespace dlo::compare
