#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "option/exit_status.hpp"
#include "option/help.hpp"
#include "option/option_values.hpp"
#include "option/output.hpp"
#include "option/reference.hpp"

namespace {

using dlo::cli::ExitStatus;

/// Nobody reads the output: as other programs, gone without a word.
[[noreturn]] void end_with_broken_pipe() {
  (void)std::signal(SIGPIPE, SIG_DFL);
  (void)std::raise(SIGPIPE);
  constexpr int as_a_shell_calls_it = 128 + SIGPIPE;
  ::_exit(as_a_shell_calls_it);  // if the caller has blocked the signal
}

/// Says what is being handled, and what that means for the exit status. It takes as little memory
/// as it can.
ExitStatus report_exception() {
  using dlo::cli::say;
  try {
    throw;
  } catch (const dlo::compare::BrokenPipe&) {
    end_with_broken_pipe();
  } catch (const dlo::compare::OutputError& error) {
    say("{}", error.what());
    return ExitStatus::not_written;
  } catch (const dlo::compare::ConvergenceError& error) {
    say("{}", error.what());
    return ExitStatus::not_converged;
  } catch (const dlo::compare::InputError& error) {
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
    dlo::cli::write_standard_error("dlo: out of memory\n");
    return ExitStatus::no_resources;
  } catch (const std::length_error&) {
    // A container that is asked for more than it can ever hold.
    dlo::cli::write_standard_error("dlo: out of memory\n");
    return ExitStatus::no_resources;
  } catch (const std::system_error& error) {
    say("out of threads or memory ({})", error.what());
    return ExitStatus::no_resources;
  } catch (const std::exception& error) {
    say("internal error, a mistake of dlo: {}", error.what());
    return ExitStatus::no_resources;
  } catch (...) {
    dlo::cli::write_standard_error("dlo: internal error, a mistake of dlo\n");
    return ExitStatus::no_resources;
  }
}

/// What no caller could catch, such as memory that a thread of the scheduler does not get, ends
/// like anything else: with a line and a status.
[[noreturn]] void end_uncaught() {
  ExitStatus status = ExitStatus::no_resources;
  if (std::current_exception()) {
    status = report_exception();
  } else {
    dlo::cli::write_standard_error("dlo: internal error, a mistake of dlo\n");
  }
  dlo::compare::remove_temporaries();
  ::_exit(static_cast<int>(status));
}

void build(CLI::App& app) {
  app.require_subcommand(1);
  app.formatter(dlo::cli::help_formatter());
  app.set_help_flag("-h,--help", "this help; with a command, its options");
  app.set_version_flag("--version", "dlo " DLO_VERSION, "the version");
  const std::string setup = "Set up";
  const auto print = [&app](std::string (*text)(const CLI::App&)) {
    dlo::cli::write_standard_output(text(app));
    throw CLI::Success();
  };
  app.add_flag_callback(
         "--man-page", [=] { print(dlo::cli::manual_page); }, "print the manual page (mdoc)")
      ->group(setup);
  app.add_flag_callback(
         "--bash-completion", [=] { print(dlo::cli::bash_completion); },
         "print completion for bash: source <(dlo --bash-completion)")
      ->group(setup);
  for (const dlo::cli::Task& task : dlo::cli::tasks()) {
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
      "not converge, 4 out of memory or threads, or a mistake of dlo, 5 an output could\n"
      "not be written. More, with examples: dlo COMMAND --help");
  app.parse_complete_callback([&app] {
    for (const CLI::App* command : app.get_subcommands()) dlo::cli::check_outputs(*command);
  });
}

int run(int argc, char** argv) {
  CLI::App app(
      "Is the shape of a simulated rod, wire or cable the shape that its material would take? "
      "dlo computes it from bending energy and gravity, and says how far others are from it.",
      "dlo");
  build(app);
  dlo::cli::refuse_empty_values(app);
  if (argc == 1) {
    dlo::cli::write_standard_output(app.help());
    return static_cast<int>(ExitStatus::good);
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
    if (error.get_exit_code() == 0) {
      std::ostringstream out;
      (void)app.exit(error, out, out);
      dlo::cli::write_standard_output(out.str());
      return static_cast<int>(ExitStatus::good);
    }
    throw dlo::compare::InputError(dlo::cli::parse_message(app, error));
  }
  return static_cast<int>(ExitStatus::good);
}

}  // namespace

int main(int argc, char** argv) {
  dlo::cli::reserve_standard_descriptors();
  dlo::compare::remove_temporaries_at_signals();
  // A limit of a file's size is an error of its write.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(end_uncaught);
  try {
    const int status = run(argc, argv);
    dlo::cli::close_standard_output();
    return status;
  } catch (...) {
    return static_cast<int>(report_exception());
  }
}
