#include "run_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "option/effect.hpp"
#include "option/help.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

void build(CLI::App& app) {
  app.require_subcommand(1);
  app.formatter(help_formatter());
  app.set_help_flag("-h,--help", "this help; with a command, its options");
  app.set_version_flag("--version", "dlo " DLO_VERSION, "the version");
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
      "not converge, 4 out of memory or threads, or an internal error, 5 an output\n"
      "could not be written. More, with examples: dlo COMMAND --help");
  app.parse_complete_callback([&app] {
    for (const CLI::App* command : app.get_subcommands()) {
      check_effects(*command);
      check_outputs(*command);
    }
  });
}

}  // namespace

int run_command(std::vector<std::string> words) {
  const compare::InputsKept kept;
  CLI::App app(
      "Is the shape of a simulated rod, wire or cable the shape that its material would take? "
      "dlo computes it from bending energy and gravity, and says how far others are from it.",
      "dlo");
  build(app);
  refuse_empty_values(app);
  if (words.empty()) {
    write_standard_output(app.help());
    return static_cast<int>(ExitStatus::good);
  }
  if (words.front() == "help") {
    // "help solve" is "solve --help".
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  if (words.front().starts_with('-')) {
    require_known_option(app, words.front());
  } else {
    require_known_command(app, words.front());
  }
  require_values(words);
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(words);
  } catch (const CLI::RuntimeError& status) {
    return status.get_exit_code();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      std::ostringstream out;
      (void)app.exit(error, out, out);
      write_standard_output(out.str());
      return static_cast<int>(ExitStatus::good);
    }
    throw compare::InputError(parse_message(app, error));
  }
  return static_cast<int>(ExitStatus::good);
}

int run_command(std::vector<std::string> words, std::string& out, std::string& err) {
  const RedirectedOutput redirected(out, err);
  try {
    return run_command(std::move(words));
  } catch (const compare::BrokenPipe&) {
    return broken_pipe_status;
  } catch (...) {
    return static_cast<int>(report_exception());
  }
}

ExitStatus report_exception() {
  try {
    throw;
  } catch (const compare::BrokenPipe&) {
    throw;
  } catch (const compare::OutputError& error) {
    say("{}", error.what());
    return ExitStatus::not_written;
  } catch (const compare::ConvergenceError& error) {
    say("{}", error.what());
    return ExitStatus::not_converged;
  } catch (const compare::InputError& error) {
    say("{}", error.what());
    return ExitStatus::bad_input;
  } catch (const std::invalid_argument& error) {
    // The models name what is out of range.
    say("{}", error.what());
    return ExitStatus::bad_input;
  } catch (const std::filesystem::filesystem_error& error) {
    say("{}", error.what());
    return ExitStatus::bad_input;
  } catch (const std::bad_alloc&) {
    write_standard_error("dlo: out of memory\n");
    return ExitStatus::no_resources;
  } catch (const std::length_error&) {
    // A container that is asked for more than it can ever hold.
    write_standard_error("dlo: out of memory\n");
    return ExitStatus::no_resources;
  } catch (const std::system_error& error) {
    say("out of threads or memory ({})", error.what());
    return ExitStatus::no_resources;
  } catch (const std::exception& error) {
    say("internal error: {}", error.what());
    return ExitStatus::no_resources;
  } catch (...) {
    write_standard_error("dlo: internal error\n");
    return ExitStatus::no_resources;
  }
}

}  // namespace dlo::cli
