// Tests of the command as a function: it behaves like the process, and leaves no state for the next
// call.

#include "run_command.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "../../sanitized.hpp"
#include "command_fixture.hpp"
#include "dlo/compare/error.hpp"
#include "option/output.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

using cli::RedirectedOutput;

class RunCommand : public Command {};

TEST_F(RunCommand, IsTheProcess) {
  succeeds("solve " + steel() + " --model force --points 8 --format csv -o " + path("s.csv"));
  // The search for explanations is disabled, because it prints its computing time.
  const std::string check = "check " + steel() + " --no-explanation --shape " + path("s.csv");
  const struct {
    std::string arguments;
    int status;
  } cases[] = {{"solve " + steel() + " --format csv", 0},
               {check + " --tolerance 0.1%", 1},
               {"solve " + steel() + " --model force --law hooke --c-c '5 kg'", 2},
               {"solve " + path("nothing.toml"), 2},
               {"slove", 2},
               {"help solve", 0},
               {"--version", 0},
               {"", 0}};
  for (const auto& one : cases) {
    const RunResult process = run_process(one.arguments);
    EXPECT_EQ(process.status, one.status) << one.arguments << process.err;
    EXPECT_NE(process.out + process.err, "") << one.arguments;
    for (const char* call : {"first", "second"}) {
      const RunResult here = run(one.arguments);
      EXPECT_EQ(here.status, process.status) << one.arguments << ", " << call;
      EXPECT_EQ(here.out, process.out) << one.arguments << ", " << call;
      EXPECT_EQ(here.err, process.err) << one.arguments << ", " << call;
    }
  }
}

TEST_F(RunCommand, TheTimeLimitHoldsForTheWholeCommand) {
  if (test::sanitized) GTEST_SKIP() << "a sanitized program reserves terabytes of address space";
  // ulimit -t ends a process that has used so many seconds of processor time; -v is in KiB.
  const std::string limits = "ulimit -t 3; ulimit -v 1000000; " + std::string(DLO_COMMAND) + " ";
  const std::string helix = scene(
      "[rod]\nlength = 30\ndiameter = 0.001\nmaterial = \"copper\"\n"
      "helix = { radius = \"2 cm\", pitch = \"2 cm\" }\n" +
      level_clamp);
  const RunResult turns = run_line(limits + "solve " + helix + " --model exact --time-limit 1");
  EXPECT_EQ(turns.status, 3) << turns.err;
  EXPECT_TRUE(has_all(turns.err, {"--time-limit 1"}));
  std::string text = steel_rod + level_clamp;
  for (int i = 0; i < 90; ++i) {
    text += fmt::format("[[section]]\nfrom = {}\nto = {}\nbending_stiffness = {}\n", i / 200.0,
                        (i + 1) / 200.0, 0.1 + 0.05 * (i % 7));
  }
  const RunResult sections = run_line(limits + "solve " + scene(text) + " --all --time-limit 0.5");
  // The search ends early, or the command does; a killed process has another status.
  EXPECT_TRUE(sections.status == 0 || sections.status == 3) << sections.status << sections.err;
}

TEST_F(RunCommand, WithoutTextsThrowsWhatItIsRefusedWith) {
  EXPECT_THROW((void)cli::run_command({"solve", path("nothing.toml")}), InputError);
}

TEST_F(RunCommand, ABrokenPipeIsAStatusAndEndsNoProcess) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  // More than a pipe holds (64 KiB), so that the reader's end is always noticed.
  const std::string solve = "solve " + steel() + " --samples 10000 --format csv -o " + path("pipe");
  std::thread reader([file = path("pipe")] { (void)std::ifstream(file).get(); });
  auto* const before = std::signal(SIGPIPE, SIG_IGN);
  const RunResult result = run(solve);
  (void)std::signal(SIGPIPE, before);
  reader.join();
  EXPECT_EQ(result.status, cli::broken_pipe_status) << result.err;
  EXPECT_EQ(result.out + result.err, "");
}

TEST(RedirectedOutputTest, HoldsForAllThreadsUntilItsEnd) {
  std::string out;
  std::string err;
  std::string inner;
  {
    const RedirectedOutput redirected(out, err);
    {
      const RedirectedOutput within(inner, inner);
      cli::write_standard_output("inner");
    }
    cli::write_standard_output("outer");
    constexpr int lines = 1000;
    const auto print_message = [] {
      for (int i = 0; i < lines; ++i) cli::print_message("a line");
    };
    std::thread other(print_message);
    print_message();
    other.join();
    EXPECT_EQ(err.size(), std::size_t{2 * lines} * std::string("dlo: a line\n").size());
  }
  EXPECT_EQ(out + inner, "outerinner");
  EXPECT_EQ(RedirectedOutput::current(), nullptr);
}

}  // namespace
}  // namespace dlo::compare
