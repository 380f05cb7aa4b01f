// Tests of progress and colours: they appear on a terminal only, and never in a result.

#include <gtest/gtest.h>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

class Terminal : public Command {
 protected:
  /// Returns the output of a successful command on a terminal.
  [[nodiscard]] std::string terminal_output(const std::string& environment,
                                            const std::string& arguments) {
    const std::string line = "env " + environment + " script -qec '" + std::string(DLO_COMMAND) +
                             " " + arguments + "' " + path("typescript") + " >/dev/null </dev/null";
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
    return read(path("typescript"));
  }

  /// Expects that a long command shows `progress` and erases all of it at the end.
  void expect_progress(const std::string& arguments, const std::string& progress) {
    const std::string text = terminal_output("TERM=xterm", arguments);
    const std::size_t shown = text.find(progress);
    const std::size_t last = text.rfind(erased);
    ASSERT_NE(shown, std::string::npos) << arguments << text;
    ASSERT_NE(last, std::string::npos) << arguments << text;
    EXPECT_LT(shown, last) << arguments << text;
    EXPECT_EQ(text.find(progress, last), std::string::npos) << arguments << text;
  }

  static constexpr const char* erased = "\r\x1b[K";
};

TEST_F(Terminal, ProgressIsShownAndErased) {
  const std::string grid = "sweep " + steel() + " --vary gamma=log:0.1:1:40 --threads 2 -o ";
  const std::string text = terminal_output("TERM=xterm", grid + path("a.csv"));
  EXPECT_TRUE(has_all(text, {"sweep [", "100 %, 40 of 40", erased}));
  // After the last erasure there is only script's own last line.
  const std::string rest = text.substr(text.rfind(erased) + 4);
  EXPECT_TRUE(has_none(rest, {"sweep"}));
  // The result is the same without a terminal, where there is no progress.
  const RunResult quiet = run(grid + path("b.csv"));
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(read(path("a.csv")), read(path("b.csv")));
}

TEST_F(Terminal, LongCommandsShowProgressAndEraseIt) {
  expect_progress("stability --case folded --stepper auto", "2 of 2");
  expect_progress("stability --map cF-cc --columns 2 --rows 8 --map-steps 100", "14 of 14");
  // The first stage is shown before anything is timed, so also if there is no time for a run.
  expect_progress("bench " + steel() + " --seconds 0.1", "bench: spring steel, -175 deg ...");
  expect_progress("compare " + steel() + " " + steel(), "2 of 2");
  expect_progress("calibrate " + steel() + " --law hooke --target 1%", "2 of 2");
}

TEST_F(Terminal, ADumbTerminalGetsPlainText) {
  const std::string text = terminal_output("TERM=dumb", "compare " + steel() + " " + steel());
  EXPECT_TRUE(has_none(text, {"\x1b"}));
}

TEST_F(Terminal, ColoursAreForTerminalsThatWantThem) {
  succeeds("solve " + steel() + " --format csv -o " + path("s.csv"));
  const std::string check = "check " + steel() + " --tolerance 1% --shape " + path("s.csv");
  const std::string green = "\x1b[32mpass\x1b[0m";
  EXPECT_TRUE(has_all(terminal_output("TERM=xterm", check), {green}));
  EXPECT_TRUE(has_none(terminal_output("TERM=xterm NO_COLOR=1", check), {green}));
  EXPECT_TRUE(has_all(terminal_output("TERM=xterm NO_COLOR=", check), {green}));
  EXPECT_TRUE(has_none(terminal_output("TERM=dumb", check), {"\x1b"}));
  EXPECT_TRUE(has_none(run(check).out, {"\x1b"}));
  (void)terminal_output("TERM=xterm", check + " -o " + path("check.txt"));
  EXPECT_EQ(read(path("check.txt")), run(check).out);
}

}  // namespace
}  // namespace dlo::compare
