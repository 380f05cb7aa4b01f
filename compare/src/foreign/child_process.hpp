#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// How a program that was run ended.
struct ChildOutcome {
  double seconds = 0;     ///< wall time from its start to its end, to a percent [s]
  std::string problem;    ///< why it did not end well: a clause without its own words; or empty
  bool too_long = false;  ///< it was killed at the time limit
  int exit_status = 0;    ///< its own; 0 too if a signal ended it
};

/// Where a program runs, and where what it writes goes.
struct ChildFiles {
  std::string folder = ".";          ///< that it runs in
  std::string output = "/dev/null";  ///< file of its standard output, as seen from there
  std::string error = "/dev/null";   ///< the same of its standard error
};

/// Runs a program, looked for in PATH, as a process group of its own and waits for it. Its standard
/// input is /dev/null. When it has ended, or at the time limit, or when a signal ends this process,
/// whatever is left of the group is killed.
/// @param words       program and arguments, one or more
/// @param time_limit  [s], > 0
[[nodiscard]] ChildOutcome run_child(const std::vector<std::string>& words, const ChildFiles& files,
                                     double time_limit);

/// The words of a command, by the rules of a POSIX shell for blanks, quotes and backslashes: 'as it
/// is', "with \" and \\ and \$ and \`", a\ b. There is no shell behind it: what one would do
/// beyond words (variables, ~, *, |, >, ;, &) is in the words as it stands.
/// @param what  for messages, such as --with
/// @throws InputError if a quote is not closed, a backslash is last, or there is no word
[[nodiscard]] std::vector<std::string> command_words(const std::string& command,
                                                     const std::string& what);

}  // namespace dlo::compare
