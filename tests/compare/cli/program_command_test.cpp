// Tests of foreign programs compared with dlo's models: dlo bench --with, dlo regress --with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

using testing::HasSubstr;

class ProgramCommand : public PythonCommand {
 protected:
  static std::string cable() { return shipped_scene("cable"); }
  /// Returns the option --with that runs the example, a chain of hinges, under this name.
  static std::string hinges(const std::string& name) {
    return with_program(name, "compare/example/foreign/hinges.py");
  }
};

TEST_F(ProgramCommand, BenchPutsAProgramBesideOurModels) {
  const RunResult result =
      run("bench --seconds 30 --repeats 1 --format json " + cable() + hinges("hinges") +
          "--with no='sh -c \"echo why >&2; exit 7\" {shape}'");
  ASSERT_EQ(result.status, 3) << result.err;
  const json document = json::parse(result.out);
  std::map<int, double> chain;
  std::map<int, double> program;
  for (const json& one : document.at("runs")) {
    if (one.at("kind") != "static") continue;
    std::map<int, double>& errors = one.at("model") == "chain" ? chain : program;
    if (one.at("model") == "chain" && one.at("law") != "hooke") continue;
    if (one.at("model") != "chain" && one.at("model") != "hinges") continue;
    EXPECT_EQ(one.at("is_program"), one.at("model") == "hinges");
    errors[one.at("size")] = one.at("rms_over_length");
    EXPECT_GT(one.at("time_s").get<double>(), 0);
  }
  // The program computes the same hinges, and its error is measured in the same way.
  ASSERT_GE(program.size(), 2U) << result.out;
  for (const auto& [points, error] : program) EXPECT_NEAR(error, chain.at(points), 1e-7) << points;
  EXPECT_LT(program.at(16), program.at(8) / 3);  // second order
  ASSERT_FALSE(document.at("failures").empty());
  const json& failure = document.at("failures").at(0);
  EXPECT_EQ(failure.at("program"), "no");
  EXPECT_EQ(failure.at("problem"), "exit status 7: why");
}

TEST_F(ProgramCommand, BenchSaysFailuresInTextAndTables) {
  const std::string arguments = "bench --seconds 2 --repeats 1 --time-limit 0.05 " + cable() +
                                " --with slow='sh -c \"sleep 9\" {shape}' ";
  expect_output(arguments, 3,
                {"  cable  slow          8  killed after the time limit of 0.05 s\n"});
  expect_output(arguments + "--format csv", 3,
                {"\ncable,static,slow,8,,,,,,,,,killed after the time limit of 0.05 s\n"});
  expect_error("bench " + cable() + " --with sim", 2, {"--with", "NAME"});
}

TEST_F(ProgramCommand, RegressKeepsAProgramsErrorByItsName) {
  const std::string arguments =
      "regress --model chain --baseline " + path("b.toml") + " " + cable();
  succeeds(arguments + hinges("mine") + "--update");
  EXPECT_THAT(read(path("b.toml")), HasSubstr("program = \"mine\"\npoints = 16\n"));
  expect_output(arguments + hinges("mine"), 0, {"same                 cable (mine, N = 16)\n"});
  expect_output(arguments + hinges("mine") + "--points 24", 1,
                {"changed              cable (mine, N = 24)\n"});
  const RunResult failed = run(arguments + " --with mine='sh -c \"echo no >&2; exit 1\" {shape}'");
  EXPECT_EQ(failed.status, 3);
  EXPECT_THAT(failed.out, HasSubstr("exit status 1: no"));
}

TEST_F(ProgramCommand, ASignalKillsTheProgram) {
  // SIGTERM is a signal that users send; SIGXCPU is sent at a limit of computing time.
  for (const int number : {SIGTERM, SIGXCPU}) {
    const std::string line = "mkdir " + path("t") + "; TMPDIR=" + path("t") + " " + DLO_COMMAND +
                             " bench --seconds 60 " + cable() + " --with slow='sh -c \"touch " +
                             path("runs") + "; sleep 2; touch " + path("late") +
                             "\" {shape}' >/dev/null 2>&1 & p=$!; while [ ! -e " + path("runs") +
                             " ]; do sleep 0.05; done; kill -" + std::to_string(number) +
                             " $p; wait $p; echo $?; ls " + path("t") + "; sleep 2.5; ls " +
                             path("late") + "; rm -r " + path("t") + " " + path("runs");
    EXPECT_EQ(run_line("sh " + write("kill.sh", line)).out, std::to_string(128 + number) + "\n");
  }
}

}  // namespace
}  // namespace dlo::compare
