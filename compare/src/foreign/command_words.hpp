#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// The words of a command, by the rules of a POSIX shell for blanks, quotes and backslashes: 'as it
/// is', "with \" and \\ and \$ and \`", a\ b. There is no shell behind it: what one would do
/// beyond words (variables, ~, *, |, >, ;, &) is in the words as it stands.
/// @param what  for messages, such as --with
/// @throws InputError if a quote is not closed, a backslash is last, or there is no word
[[nodiscard]] std::vector<std::string> command_words(const std::string& command,
                                                     const std::string& what);

}  // namespace dlo::compare
