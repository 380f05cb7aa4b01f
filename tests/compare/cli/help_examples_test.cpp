// Every example of every --help is run; manual page and completion know every option.

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

#include "command_fixture.hpp"
#include "dlo/compare/deviation.hpp"

namespace {

using dlo::test::Command;
using dlo::test::Outcome;
using dlo::test::says;

class Reference : public Command {
 protected:
  /// Runs a bash script in the test's folder, with data/ beside it and dlo in the path.
  [[nodiscard]] Outcome bash(const std::string& script) const {
    const std::filesystem::path command(DLO_COMMAND);
    std::ofstream(path("script")) << "set -e\ncd " << path("") << "\n[ -e data ] || ln -s "
                                  << DLO_DATA << " data\nexport PATH=" << command.parent_path()
                                  << ":$PATH\n"
                                  << script << "\n";
    return run_line("bash " + path("script"));
  }

  /// What the completion offers for the last of these words.
  [[nodiscard]] std::vector<std::string> completions(const std::string& words) const {
    const Outcome result =
        bash("source <(dlo --bash-completion)\nset +e\nCOMP_WORDS=(" + words +
             ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_dlo\nprintf '%s\\n' \"${COMPREPLY[@]}\"");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "") << words;
    return lines_of(result.out);
  }

  [[nodiscard]] static std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) all.push_back(line);
    return all;
  }

  /// What fish offers for the last word of a line, without descriptions.
  [[nodiscard]] std::vector<std::string> fish_completions(const std::string& line) const {
    std::ofstream(path("line.fish"))
        << "dlo --fish-completion | source\ncomplete -C '" << line << "'\n";
    const Outcome result = bash("fish --no-config line.fish");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "") << line;
    std::vector<std::string> offered = lines_of(result.out);
    for (std::string& word : offered) word.resize(std::min(word.size(), word.find('\t')));
    return offered;
  }

  /// The words of a line in which zsh has completed what is before each tab.
  [[nodiscard]] std::string zsh_completed(const std::string& line) const {
    std::ofstream(path("line.zsh"))
        << "zmodload zsh/zpty\nexport TERM=vt100\nzpty shell zsh -f -i\n"
           "zpty -w shell 'PS1=; autoload -U compinit; compinit -u -D'\n"
           "zpty -w shell 'source <(command dlo --zsh-completion)'\n"
           "zpty -w shell 'dlo() { print -r -- \"comp\"\"leted[$*]\" }; print -r -- re\"\"ady'\n"
           "zpty -r shell out '*ready*'\n"
           "zpty -w -n shell $'"
        << line << "\\n'\nzpty -r shell out '*completed\\[*\\]*'\nprint -r -- $out\n";
    const Outcome result = bash("timeout 60 zsh -f line.zsh");
    EXPECT_EQ(result.status, 0) << result.err;
    const std::vector<std::string> found = matches(result.out, "completed\\[([^\\]]*)\\]");
    return found.empty() ? "nothing in " + result.out : found.front();
  }

  [[nodiscard]] static bool contains(const std::vector<std::string>& words,
                                     const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }

  /// All matches of the first group.
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

  [[nodiscard]] std::vector<std::string> options_of(const std::string& command) const {
    return matches(run(command + " --help").out, "\n  (?:-[a-z], )?(--[A-Za-z-]+)");
  }
};

TEST_F(Reference, EveryExampleOfEveryHelpWorks) {
  // Longer than all others together: command_test and report_command_test run just these.
  const std::map<std::string, std::string> elsewhere = {
      {"paper", "dlo paper --format json -o paper.json"},
      {"report", "dlo report data/scenes/cable.toml --quick -o report"}};
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
      const Outcome result = bash(example);
      EXPECT_EQ(result.status, 0) << example << "\n" << result.err;
    }
  }
}

TEST_F(Reference, ManualPageIsWellFormedAndKnowsEveryOption) {
  const Outcome page = run("--man-page");
  EXPECT_EQ(page.status, 0);
  for (const std::string section :
       {"NAME", "SYNOPSIS", "COMMANDS", "ENVIRONMENT", "FILES", "EXIT STATUS", "EXAMPLES"}) {
    EXPECT_TRUE(says(page.out, {"\n.Sh " + section + "\n"})) << section;
  }
  if (bash("command -v mandoc").status != 0) GTEST_SKIP() << "no mandoc";
  const Outcome lint = bash("dlo --man-page >dlo.1; mandoc -Tlint -Wwarning dlo.1");
  EXPECT_EQ(lint.status, 0) << lint.out;
  const std::string shown = bash("mandoc -Tascii dlo.1 | sed 's/.\x08//g'").out;
  for (const std::string& command : commands()) {
    for (const std::string& option : options_of(command)) {
      EXPECT_TRUE(says(shown, {option})) << command;
    }
  }
}

TEST_F(Reference, BashCompletesCommandsOptionsAndChoices) {
  const std::vector<std::string> offered = completions("dlo ''");
  for (const std::string& command : commands()) {
    EXPECT_TRUE(contains(offered, command)) << command;
    const std::vector<std::string> options = completions("dlo " + command + " --");
    for (const std::string& option : options_of(command)) {
      EXPECT_TRUE(contains(options, option)) << command << " " << option;
    }
  }
  using Words = std::vector<std::string>;
  EXPECT_EQ(completions("dlo solve --model ''"), (Words{"energy", "chain", "exact", "force"}));
  EXPECT_EQ(completions("dlo solve --model = ch"), Words{"chain"});
  EXPECT_EQ(completions("dlo compare --law h"), Words{"hooke"});
  EXPECT_TRUE(contains(completions("dlo solve --format ''"), "vtk"));
  EXPECT_EQ(completions("dlo init --material silicone"), (Words{"silicone", "silicone_cable"}));
  EXPECT_EQ(completions("dlo re"), (Words{"report", "regress"}));
}

TEST_F(Reference, BashCompletesSceneFiles) {
  std::ofstream(path("my cable.toml")) << "";
  std::ofstream(path("mine.csv")) << "";
  using Words = std::vector<std::string>;
  EXPECT_EQ(completions("dlo solve m"), Words{"my cable.toml"});
  EXPECT_EQ(completions("dlo check a.toml --shape mi"), Words{"mine.csv"});
  EXPECT_EQ(completions("dlo compare data/scenes/ca"), Words{"data/scenes/cable.toml"});
  EXPECT_EQ(completions("dlo solve --points ''"), Words{""});
}

TEST_F(Reference, FishCompletesCommandsOptionsChoicesAndFiles) {
  if (bash("command -v fish").status != 0) GTEST_SKIP() << "no fish";
  std::ofstream(path("my_cable.toml")) << "";
  std::ofstream(path("mine.csv")) << "";
  const std::vector<std::string> offered = fish_completions("dlo ");
  for (const std::string& command : commands()) {
    EXPECT_TRUE(contains(offered, command)) << command;
    const std::vector<std::string> options = fish_completions("dlo " + command + " --");
    for (const std::string& option : options_of(command)) {
      EXPECT_TRUE(contains(options, option)) << command << " " << option;
    }
  }
  const auto sorted = [this](const std::string& line) {
    std::vector<std::string> words = fish_completions(line);
    std::sort(words.begin(), words.end());
    return words;
  };
  using Words = std::vector<std::string>;
  EXPECT_EQ(sorted("dlo solve --model "), (Words{"chain", "energy", "exact", "force"}));
  EXPECT_EQ(sorted("dlo check a.toml --register=u"), Words{"--register=upright"});
  EXPECT_EQ(sorted("dlo solve --points "), Words{});
  EXPECT_EQ(fish_completions("dlo solve my").front(), "my_cable.toml");  // before other files
  EXPECT_EQ(sorted("dlo check a.toml --shape mi"), Words{"mine.csv"});
}

TEST_F(Reference, ZshCompletesCommandsOptionsChoicesAndFiles) {
  if (bash("command -v zsh").status != 0) GTEST_SKIP() << "no zsh";
  std::ofstream(path("my_cable.toml")) << "";
  std::ofstream(path("my_points.csv")) << "";
  EXPECT_EQ(zsh_completed("dlo mat\\t"), "materials");
  EXPECT_EQ(zsh_completed("dlo solve --max-e\\t"), "solve --max-evaluations");
  EXPECT_EQ(zsh_completed("dlo solve --model=ch\\t"), "solve --model=chain");
  EXPECT_EQ(zsh_completed("dlo check --register=u\\t"), "check --register=upright");
  EXPECT_EQ(zsh_completed("dlo solve my\\t"), "solve my_cable.toml");
  EXPECT_EQ(zsh_completed("dlo check --shape=my_p\\t"), "check --shape=my_points.csv");
  const std::string text = run("--zsh-completion").out;
  for (const std::string& command : commands()) {
    const std::size_t begin = text.find("    " + command + ")\n");
    ASSERT_NE(begin, std::string::npos) << command;
    const std::string its = text.substr(begin, text.find(";;", begin) - begin);
    for (const std::string& option : options_of(command)) {
      EXPECT_TRUE(says(its, {option})) << command;
    }
  }
}

}  // namespace
