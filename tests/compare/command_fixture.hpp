#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../helpers.hpp"
#include "../says.hpp"
#include "csv_table.hpp"
#include "folder_fixture.hpp"
#include "run_command.hpp"
#include "shell_words.hpp"

namespace dlo::test {

using nlohmann::json;

/// Result of a command.
struct RunResult {
  int status = -1;
  std::string out;
  std::string err;
};

/// Fixture that runs the command, with a private folder for its files.
class Command : public Folder {
 protected:
  /// Returns the words, each followed by a blank.
  static std::string words(std::initializer_list<std::string> list) {
    std::string line;
    for (const std::string& word : list) line.append(word).append(" ");
    return line;
  }

  [[nodiscard]] std::string scene(const std::string& text) const {
    return write("scene.toml", text);
  }

  /// Runs the command within this process, which is faster; arguments that need a shell start a
  /// process.
  [[nodiscard]] RunResult run(const std::string& arguments) const {
    std::optional<std::vector<std::string>> list = shell_words(arguments);
    if (!list) return run_process(arguments);
    RunResult result;
    result.status = cli::run_command(std::move(*list), result.out, result.err);
    return result;
  }

  /// Returns the standard output of a command, and expects this exit status.
  [[nodiscard]] std::string output_of(const std::string& arguments, int status = 0) const {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    return result.out;
  }

  /// Expects this exit status, and all of `words` in the two outputs of a command.
  void expect_output(const std::string& arguments, int status,
                     const std::vector<std::string>& words) const {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_TRUE(has_all(result.out + result.err, words)) << arguments;
  }

  /// Runs a command for the files that it writes, and expects exit status 0.
  void succeeds(const std::string& arguments) const { (void)output_of(arguments); }

  /// Returns the document that a command prints with --format json, and expects this exit status.
  [[nodiscard]] json json_of(const std::string& arguments, int status = 0) const {
    return json::parse(output_of(arguments + " --format json", status));
  }

  /// Returns rows x, y, z, s [m] of the shape that `dlo solve` finds with these arguments.
  [[nodiscard]] std::vector<std::vector<double>> solved_points(const std::string& arguments) const {
    return csv_numbers(csv_rows(output_of("solve " + arguments + " --format csv")), 1);
  }

  /// Writes rows of numbers below a header, of each as many as the header has names.
  /// @return the file's path
  [[nodiscard]] std::string write_table(const std::string& name, const std::string& header,
                                        const std::vector<std::vector<double>>& rows) const {
    std::string text = header + "\n";
    const auto columns = std::count(header.begin(), header.end(), ',') + 1;
    for (const std::vector<double>& row : rows) {
      text += fmt::format("{}\n", fmt::join(row.begin(), row.begin() + columns, ","));
    }
    return write(name, text);
  }

  /// Writes the shape that `dlo solve` finds with these arguments. @return the file's path
  [[nodiscard]] std::string solved_file(const std::string& arguments,
                                        const std::string& name = "solved.csv") const {
    succeeds("solve " + arguments + " --format csv -o " + path(name));
    return path(name);
  }

  /// Returns the largest difference of a coordinate of two documents' points [m].
  static double largest_coordinate_difference(const json& a, const json& b) {
    EXPECT_EQ(a.at("points_m").size(), b.at("points_m").size());
    double apart = 0;
    for (std::size_t i = 0; i < a.at("points_m").size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        apart = std::max(apart, std::abs(a.at("points_m")[i][k].get<double>() -
                                         b.at("points_m")[i][k].get<double>()));
      }
    }
    return apart;
  }

  /// Runs the command as a process, for tests of processes.
  [[nodiscard]] RunResult run_process(const std::string& arguments) const {
    return run_line(std::string(DLO_COMMAND) + " " + arguments);
  }

  /// Runs a line in a shell. RunResult::err has the standard error of the line's last command only;
  /// the status is -1 if a signal ends the shell.
  [[nodiscard]] RunResult run_line(const std::string& command) const {
    const std::string line = command + " 2>" + path("stderr");
    std::FILE* pipe = ::popen(line.c_str(), "r");
    RunResult result;
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

  /// Expects bad input: this status, nothing on standard output, and one line that contains all of
  /// `names`.
  void expect_error(const std::string& arguments, int status,
                    const std::vector<std::string>& names) const {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(has_all(result.err, names));
  }

  /// Returns the path of a scene of data/scenes.
  static std::string shipped_scene(const std::string& name) {
    return DLO_DATA "/scenes/" + name + ".toml";
  }

  static std::string steel() { return shipped_scene("spring_steel_175"); }
};

/// Fixture of commands that run programs in Python.
class PythonCommand : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    if (run_line("[ -x /usr/bin/python3 ]").status != 0) GTEST_SKIP() << "no python3";
  }

  /// Returns the option --with that runs a program of the repository under this name.
  static std::string with_program(const std::string& name, const std::string& program) {
    return " --with " + name + "='/usr/bin/python3 " DLO_DATA "/../" + program +
           " {scene} {points} {shape}' ";
  }
};

}  // namespace dlo::test
