#include "run_command.hpp"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/temporary_path.hpp"
#include "command/commands.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "option/command_line.hpp"
#include "option/effect.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

/// Time of the steady clock at which the command has to end [s]; infinite: never.
std::atomic<double> command_end = std::numeric_limits<double>::infinity();
std::string time_limit_message;  // message of the signal handler, written before the timer starts

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool is_time_limit_exceeded() { return steady_seconds() > command_end; }

extern "C" void end_command_at_time_limit(int /*number*/) {
  compare::end_groups();
  // If standard error cannot be written, the exit status still reports it.
  [[maybe_unused]] const ssize_t written =
      ::write(STDERR_FILENO, time_limit_message.data(), time_limit_message.size());
  ::_exit(static_cast<int>(ExitStatus::not_converged));
}

/// Enforces --time-limit for a whole command: solvers of this thread stop when the time is over. If
/// the computation does not stop soon after that, the process ends with a message, except during a
/// library call (RedirectedOutput).
class CommandTimeLimit {
 public:
  CommandTimeLimit(const std::string& command, double seconds)
      : interruption_(is_time_limit_exceeded) {
    command_end = steady_seconds() + seconds;
    if (RedirectedOutput::current() != nullptr) return;  // a library call must not end its process
    time_limit_message = fmt::format(
        "dlo: {}: not finished within --time-limit {:g} s (allowed: a longer time limit, or a "
        "smaller scene)\n",
        command, seconds);
    struct sigaction action = {};
    action.sa_handler = end_command_at_time_limit;
    ::sigfillset(&action.sa_mask);
    ::sigaction(SIGALRM, &action, nullptr);
    constexpr double tolerance_factor = 1.05;
    constexpr double timer_margin_seconds = 0.5;
    start_timer(tolerance_factor * seconds + timer_margin_seconds);
  }
  ~CommandTimeLimit() {
    start_timer(0);
    command_end = std::numeric_limits<double>::infinity();
  }
  CommandTimeLimit(const CommandTimeLimit&) = delete;
  CommandTimeLimit& operator=(const CommandTimeLimit&) = delete;

 private:
  /// @param seconds  0: stops the timer
  static void start_timer(double seconds) {
    if (RedirectedOutput::current() != nullptr) return;
    itimerval timer{};
    timer.it_value.tv_sec = static_cast<time_t>(seconds);
    timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
    (void)::setitimer(ITIMER_REAL, &timer, nullptr);
  }

  energy_model::Interruption interruption_;
};

/// Returns the limit that --time-limit sets for the whole command. Returns std::nullopt if the
/// option is not given, or if it limits each of many runs.
std::optional<double> whole_time_limit(const CLI::App& command) {
  constexpr std::string_view of_each_run[] = {"bench", "regress", "suite", "sweep"};
  if (std::ranges::find(of_each_run, command.get_name()) != std::end(of_each_run)) return {};
  const CLI::Option* option = command.get_option_no_throw("--time-limit");
  if (option == nullptr || option->count() == 0) return {};
  return option->as<double>();
}

/// Adds the command `chosen`; all commands if there is none of that name.
void build(CLI::App& app, std::optional<CommandTimeLimit>& limit, const std::string& chosen) {
  app.require_subcommand(1);
  app.formatter(help_formatter());
  app.set_help_flag("-h,--help", "this help; with a command, its options");
  app.set_version_flag("--version", "dlo " DLO_VERSION, "the version");
  const auto* const own = std::ranges::find(all_commands, chosen, &NamedCommand::name);
  for (const NamedCommand& command : all_commands) {
    if (own == std::end(all_commands) || own == &command) command.add(app);
  }
  app.footer(
      "Begin with:\n"
      "  dlo init cable.toml --length \"2 m\" --diameter \"6 mm\" --material silicone\n"
      "  dlo solve cable.toml\n\n"
      "Exit status: 0 good, 1 outside a tolerance, 2 bad usage or input, 3 a solver did\n"
      "not converge, 4 out of memory or threads, or an internal error, 5 an output\n"
      "could not be written. More, with examples: dlo COMMAND --help");
  app.parse_complete_callback([&app, &limit] {
    for (const CLI::App* command : app.get_subcommands()) {
      if (const std::optional<double> seconds = whole_time_limit(*command)) {
        limit.emplace(command->get_name(), *seconds);
      }
      check_effects(*command);
      check_outputs(*command);
    }
  });
}

ExitStatus print_error(const std::exception& error, ExitStatus status) {
  print_message("{}", error.what());
  return status;
}

}  // namespace

int run_command(std::vector<std::string> words) {
  const compare::InputsKept kept;
  CLI::App app(
      "Is the shape of a simulated rod, wire or cable the shape that its material would take? dlo "
      "computes it from bending energy and gravity, and prints how far other shapes are from it.",
      "dlo");
  std::optional<CommandTimeLimit> limit;
  if (words.empty()) words.emplace_back("--help");
  if (words.front() == "help") {
    // "help solve" is equivalent to "solve --help".
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  build(app, limit, words.front());
  require_known_word(app, words.front());
  require_values(words);
  std::reverse(words.begin(), words.end());  // CLI11 expects the reverse order
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
    return print_error(error, ExitStatus::not_written);
  } catch (const compare::ConvergenceError& error) {
    return print_error(error, ExitStatus::not_converged);
  } catch (const compare::InputError& error) {
    return print_error(error, ExitStatus::bad_input);
  } catch (const std::invalid_argument& error) {
    // The message of the model names the value that is out of range.
    return print_error(error, ExitStatus::bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    return print_error(error, ExitStatus::bad_input);
  } catch (const std::bad_alloc&) {
    write_standard_error("dlo: out of memory\n");
  } catch (const std::length_error&) {
    // A container was requested that exceeds its largest size.
    write_standard_error("dlo: out of memory\n");
  } catch (const std::system_error& error) {
    print_message("out of threads or memory ({})", error.what());
  } catch (const std::exception& error) {
    print_message("internal error: {}", error.what());
  } catch (...) {
    write_standard_error("dlo: internal error\n");
  }
  return ExitStatus::no_resources;
}

}  // namespace dlo::cli
