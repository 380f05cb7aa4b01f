#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "option/exit_status.hpp"

namespace dlo::cli {

/// As a shell calls the status of a program whose output nobody reads.
inline constexpr int broken_pipe_status = 128 + SIGPIPE;

/// The command `dlo`, without what belongs to a process (main.cpp): its signals, its descriptors,
/// its end. Nothing of it is left for the next call.
/// @param words  behind the program's name
/// @return the exit status
/// @throws what the command is refused with, or fails with, and nothing has been said of; see
///     report_exception()
[[nodiscard]] int run_command(std::vector<std::string> words);

/// The same with standard output and standard error in two texts. What it throws becomes the
/// message and the status of the process; an -o that is a pipe which nobody reads raises SIGPIPE,
/// and where the caller ignores that, it becomes broken_pipe_status. One call at a time: where
/// output goes holds for all threads. What names the process's own descriptors, such as -o
/// /dev/stdout, is written there.
/// @param[out] out, err  appended to, not overwritten
[[nodiscard]] int run_command(std::vector<std::string> words, std::string& out, std::string& err);

/// Says on standard error what is being handled, and what that means for the exit status. It takes
/// as little memory as it can.
/// @throws compare::BrokenPipe if that is what is being handled: of it nothing is said
[[nodiscard]] ExitStatus report_exception();

}  // namespace dlo::cli
