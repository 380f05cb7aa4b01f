#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../says.hpp"
#include "folder_fixture.hpp"
#include "run_command.hpp"
#include "shell_words.hpp"

namespace dlo::test {

/// What a command left.
struct Outcome {
  int status = -1;
  std::string out;
  std::string err;
};

/// Runs the command in a folder of its own.
class Command : public Folder {
 protected:
  /// Words with blanks between them.
  static std::string words(std::initializer_list<std::string> list) {
    std::string line;
    for (const std::string& word : list) line.append(word).append(" ");
    return line;
  }

  [[nodiscard]] std::string scene(const std::string& text) const {
    return write("scene.toml", text);
  }

  /// The command within this process, which is faster; arguments that need a shell bring a process.
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    std::optional<std::vector<std::string>> list = shell_words(arguments);
    if (!list) return run_process(arguments);
    Outcome result;
    result.status = cli::run_command(std::move(*list), result.out, result.err);
    return result;
  }

  /// The document of a command.
  [[nodiscard]] nlohmann::json json_of(const std::string& arguments, int status = 0) const {
    const Outcome result = run(arguments + " --format json");
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    return nlohmann::json::parse(result.out);
  }

  /// A process of the command: for what is about processes.
  [[nodiscard]] Outcome run_process(const std::string& arguments) const {
    return run_line(std::string(DLO_COMMAND) + " " + arguments);
  }

  /// Any line of a shell, a single command.
  [[nodiscard]] Outcome run_line(const std::string& command) const {
    const std::string line = command + " 2>" + path("stderr");
    std::FILE* pipe = ::popen(line.c_str(), "r");
    Outcome result;
    std::array<char, 4096> buffer{};
    std::size_t count = 0;
    while ((count = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0) {
      result.out.append(buffer.data(), count);
    }
    const int status = ::pclose(pipe);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.err = read(path("stderr"));
    return result;
  }

  /// Bad input: this status, nothing on standard output, one line that names all of `names`.
  void expect_error(const std::string& arguments, int status,
                    const std::vector<std::string>& names) const {
    const Outcome result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(says(result.err, names));
  }

  static std::string steel() { return std::string(DLO_DATA) + "/scenes/spring_steel_175.toml"; }
};

}  // namespace dlo::test
