// Tests of --help: every example runs, no option accepts an empty value, and the manual page that
// help2man makes lists every command.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>

#include "command_fixture.hpp"
#include "dlo/compare/deviation.hpp"

namespace dlo::compare {
namespace {

class HelpExamples : public Command {
 protected:
  /// Runs a bash script in the test's folder, with data/ and a simulator next to it and dlo in the
  /// path.
  [[nodiscard]] RunResult bash(const std::string& script) const {
    const std::filesystem::path command(DLO_COMMAND);
    std::ofstream(path("script")) << "set -e\ncd " << path("") << "\n[ -e data ] || ln -s "
                                  << DLO_DATA << " data\n[ -e mine.py ] || cp " << DLO_DATA
                                  << "/../compare/example/foreign/hinges.py mine.py\nexport PATH="
                                  << command.parent_path() << ":$PATH\n"
                                  << script << "\n";
    return run_line("bash " + path("script"));
  }

  /// Returns what the first group of the pattern captures in each match.
  [[nodiscard]] static std::vector<std::string> matches(const std::string& text,
                                                        const std::string& pattern) {
    std::vector<std::string> found;
    const std::regex expression(pattern);
    for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end;
         ++match) {
      found.push_back((*match)[1]);
    }
    return found;
  }

  [[nodiscard]] std::vector<std::string> commands() const {
    return matches(run("").out, "\n  ([a-z]+)   *[a-z]");
  }
};

TEST_F(HelpExamples, EveryExampleOfEveryHelpWorks) {
  // This example takes longer than all others together; command_test runs it instead.
  const std::map<std::string, std::string> elsewhere = {
      {"paper", "dlo paper --format json -o paper.json"}};
  const std::vector<std::string> all = commands();
  EXPECT_GE(all.size(), 11U);
  for (const std::string& command : all) {
    std::string help = run(command + " --help").out;
    help = std::regex_replace(help, std::regex("\\\\\n *"), "");
    const std::vector<std::string> examples = matches(help, "\n  (dlo [^\n]*)");
    EXPECT_FALSE(examples.empty()) << command;
    const auto known = elsewhere.find(command);
    if (known != elsewhere.end()) {
      EXPECT_EQ(examples, std::vector<std::string>{known->second});
      continue;
    }
    for (const std::string& example : examples) {
      const RunResult result = bash(example);
      EXPECT_EQ(result.status, 0) << example << "\n" << result.err;
    }
  }
}

TEST_F(HelpExamples, NoOptionOfAnyCommandTakesAnEmptyValue) {
  std::size_t count = 0;
  for (const std::string& command : commands()) {
    const std::string help = run(command + " --help").out;
    for (const std::string& option : matches(help, "\n  (?:-\\w, )?(--[^ ]+) [^ ]")) {
      expect_error(words({command, option, "''"}), 2, {option, "the value is empty"});
      ++count;
    }
  }
  EXPECT_GE(count, 100U);
  expect_error("solve " + steel() + " --time-limit= --samples 3", 2,
               {"--time-limit", "the value is empty"});
  expect_error("solve ''", 2, {"SCENE", "the value is empty"});
}

TEST_F(HelpExamples, ManualPageOfThePackageListsEveryCommand) {
  if (bash("command -v help2man").status != 0) GTEST_SKIP() << "no help2man";
  const RunResult page = bash("help2man --no-info --name models dlo");
  EXPECT_EQ(page.status, 0) << page.err;
  EXPECT_TRUE(has_all(page.out, {".SH NAME\ndlo", ".SH SYNOPSIS", "Exit status: 0 good"}));
  for (const std::string& command : commands()) {
    EXPECT_TRUE(has_all(page.out, {"\n" + command})) << command;
  }
}

}  // namespace
}  // namespace dlo::compare
