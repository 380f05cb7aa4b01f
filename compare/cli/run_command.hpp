#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "option/output.hpp"

namespace dlo::cli {

/// Exit status that a shell reports for a program whose output nobody reads.
inline constexpr int broken_pipe_status = 128 + SIGPIPE;

/// Runs the command `dlo`, without the parts that belong to a process (main.cpp): signals,
/// descriptors, termination. A call leaves no state for the next call.
/// @param words  words after the program's name
/// @return the exit status
/// @throws any exception that has not been reported; see report_exception()
[[nodiscard]] int run_command(std::vector<std::string> words);

/// Runs the command with standard output and standard error redirected to two texts. Exceptions
/// become the message and the exit status of the process. If -o is a pipe that nobody reads,
/// SIGPIPE is raised; if the caller ignores it, the result is broken_pipe_status. Only one call at
/// a time is allowed, because the redirection applies to all threads. Files that are descriptors of
/// the process, such as -o /dev/stdout, are written directly.
/// @param[out] out, err  appended to, not overwritten
[[nodiscard]] int run_command(std::vector<std::string> words, std::string& out, std::string& err);

/// Reports the exception that is being handled on standard error, and returns its exit status. Uses
/// as little memory as possible.
/// @throws compare::BrokenPipe if that is the exception; it is not reported
[[nodiscard]] ExitStatus report_exception();

}  // namespace dlo::cli
