#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands.hpp"
#include "dlo/compare/error.hpp"
#include "help.hpp"
#include "option_values.hpp"
#include "reference.hpp"

namespace {

// 1, outside a tolerance, is a CLI::RuntimeError of a command that has printed its result.
enum ExitStatus : int { good = 0, bad_input = 2, not_converged = 3 };

int report(ExitStatus status, const std::exception& error) {
  std::string line = error.what();
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  fmt::print(stderr, "dlo: {}\n", line);
  return status;
}

/// Commands by what a user wants to do.
struct Task {
  const char* what;
  std::vector<void (*)(CLI::App&)> commands;
};

const std::vector<Task>& tasks() {
  using namespace dlo::cli;
  static const std::vector<Task> list = {
      {"Begin", {add_init, add_materials}},
      {"See a shape", {add_solve}},
      {"Is my simulator's shape right?", {add_check}},
      {"Get parameters", {add_calibrate}},
      {"How far is the force model from physics, and why?", {add_compare, add_report, add_paper}},
      {"What does accuracy cost?", {add_bench, add_stability}},
      {"Many scenes", {add_sweep}},
      {"Keep it from getting worse", {add_regress}},
  };
  return list;
}

void build(CLI::App& app) {
  app.require_subcommand(1);
  app.formatter(dlo::cli::help_formatter());
  app.set_help_flag("-h,--help", "this help; with a command, its options");
  app.set_version_flag("--version", "dlo " DLO_VERSION, "the version");
  const std::string setup = "Set up";
  const auto print = [&app](std::string (*text)(const CLI::App&)) {
    fmt::print("{}", text(app));
    throw CLI::Success();
  };
  app.add_flag_callback(
         "--man-page", [=] { print(dlo::cli::manual_page); }, "print the manual page (mdoc)")
      ->group(setup);
  app.add_flag_callback(
         "--bash-completion", [=] { print(dlo::cli::bash_completion); },
         "print completion for bash: source <(dlo --bash-completion)")
      ->group(setup);
  for (const Task& task : tasks()) {
    for (const auto add : task.commands) {
      add(app);
      app.get_subcommands({}).back()->group(task.what);
    }
  }
  app.footer(
      "Begin with:\n"
      "  dlo init cable.toml --length \"2 m\" --diameter \"6 mm\" --material silicone\n"
      "  dlo solve cable.toml\n\n"
      "Exit status: 0 good, 1 outside a tolerance, 2 bad usage or input, 3 a solver did\n"
      "not converge. More, with examples: dlo COMMAND --help");
}

int run(int argc, char** argv) {
  CLI::App app(
      "Is the shape of a simulated rod, wire or cable the shape that its material would take? "
      "dlo computes it from bending energy and gravity, and says how far others are from it.",
      "dlo");
  build(app);
  dlo::cli::refuse_empty_values(app);
  if (argc == 1) {
    fmt::print("{}", app.help());
    return good;
  }
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.front() == "help") {
    // "help solve" is "solve --help".
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  if (words.front().starts_with('-')) {
    dlo::cli::require_known_option(app, words.front());
  } else {
    dlo::cli::require_known_command(app, words.front());
  }
  dlo::cli::require_values(words);
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(words);
  } catch (const CLI::RuntimeError& status) {
    return status.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    throw dlo::compare::InputError(dlo::cli::parse_message(app, error));
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const dlo::compare::InputError& error) {
    return report(bad_input, error);
  } catch (const std::invalid_argument& error) {
    return report(bad_input, error);
  } catch (const std::filesystem::filesystem_error& error) {
    return report(bad_input, error);
  } catch (const std::exception& error) {
    return report(not_converged, error);
  }
}
