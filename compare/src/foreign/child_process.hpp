#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// Result of a program that was run.
struct ChildOutcome {
  double seconds = 0;  ///< wall time from start to end, accurate to 1 % or 50 us [s]
  /// Clause that states why the program failed, without its own output; empty on success.
  std::string problem;
  bool too_long = false;  ///< whether the program was killed at the time limit
  int exit_status = 0;    ///< exit status of the program; 0 too if it did not exit by itself
};

/// Working directory of a program, and files for its output.
struct ChildFiles {
  std::string folder = ".";          ///< working directory
  std::string output = "/dev/null";  ///< file of standard output, relative to `folder`
  std::string error = "/dev/null";   ///< file of standard error, relative to `folder`
};

/// Runs a program, found by PATH, as a process group of its own and waits for it. Its standard
/// input is /dev/null. The group is killed when the program has ended, at the time limit, or when a
/// signal ends this process (TemporaryGroup).
/// @param words       program and arguments, one or more
/// @param time_limit  [s], > 0
[[nodiscard]] ChildOutcome run_child(const std::vector<std::string>& words, const ChildFiles& files,
                                     double time_limit);

/// Splits a command into words by the rules of a POSIX shell for blanks, quotes and backslashes:
/// 'as it is', "with \" and \\ and \$ and \`", a\ b. No shell is run: whatever else a shell would
/// interpret (variables, ~, *, |, >, ;, &) remains in the words unchanged.
/// @param what  name of the option in messages, such as --with
/// @throws InputError if a quote is not closed, a backslash is last, or there is no word
[[nodiscard]] std::vector<std::string> command_words(const std::string& command,
                                                     const std::string& what);

}  // namespace dlo::compare
