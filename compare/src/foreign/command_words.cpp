#include <fmt/format.h>

#include <string_view>

#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "foreign/child_process.hpp"

namespace dlo::compare {

std::vector<std::string> command_words(const std::string& command, const std::string& what) {
  constexpr std::string_view blanks = " \t\n";
  // Characters that a backslash escapes within double quotes.
  constexpr std::string_view escaped = "\"\\$`";
  const auto fail = [&](const std::string& problem) {
    throw InputError(fmt::format(
        "{}: the command {} {} (allowed: words as a shell takes them, blanks in quotes)", what,
        quoted_piece(command), problem));
  };
  std::vector<std::string> words;
  bool open = false;  // inside a word, which may be empty: ''
  char quote = '\0';  // quote that is open; '\0': none
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (quote == '\0' && blanks.find(c) != std::string_view::npos) {
      open = false;
      continue;
    }
    if (!open) words.emplace_back();
    open = true;
    if (c == quote) {
      quote = '\0';
    } else if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == '\\' && quote != '\'' && i + 1 < command.size()) {
      const char next = command[++i];
      if (quote == '"' && escaped.find(next) == std::string_view::npos) words.back() += c;
      words.back() += next;
    } else if (c == '\\' && quote == '\0') {
      fail("ends with a backslash");
    } else {
      words.back() += c;
    }
  }
  if (quote != '\0') fail(fmt::format("has a {} that is not closed", quote));
  if (words.empty()) fail("is empty");
  return words;
}

}  // namespace dlo::compare
