#pragma once

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "../helpers.hpp"
#include "command_fixture.hpp"

namespace dlo::test {

/// Fixture that runs lines of bash in a private folder, for tests of the command's output.
class Output : public Command {
 protected:
  /// Runs a line of bash. If it has several commands, the standard error contains that of all.
  [[nodiscard]] RunResult bash(const std::string& script) const {
    std::ofstream(path("script")) << "cd " << path("") << "\ndlo=" << DLO_COMMAND << "\n"
                                  << script << "\n";
    return run_line("bash " + path("script"));
  }

  void write_scene(const std::string& name) const { write(name, read(steel())); }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names = Command::files();
    std::erase_if(names, [](const auto& name) { return name == "script" || name == "stderr"; });
    return names;
  }

  [[nodiscard]] static bool one_line(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n') == 1 && text.ends_with('\n');
  }

  /// Expects a refusal with status 2 before the scene is solved, which would end with status 3.
  void expect_refused(const std::string& arguments, const std::vector<std::string>& names) const {
    expect_error(arguments + " --max-evaluations 1", 2, names);
  }
};

}  // namespace dlo::test
