#pragma once

#include <CLI/CLI.hpp>

namespace dlo::cli {

/// Exit status of a command.
enum class ExitStatus : int {
  good = 0,
  outside_tolerance = 1,
  bad_input = 2,
  not_converged = 3,
  no_resources = 4,  ///< also for internal errors
  not_written = 5,
};

/// Ends a command that has printed its result.
[[noreturn]] inline void end_with(ExitStatus status) {
  throw CLI::RuntimeError(static_cast<int>(status));
}

}  // namespace dlo::cli
