#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::test {

/// The words into which sh(1) splits a line: blanks between them, quotes and backslashes.
/// @return nothing if the line has anything else that a shell acts on, such as pipes, variables and
///     patterns
inline std::optional<std::vector<std::string>> shell_words(std::string_view line) {
  enum class Quotes { none, one, two };
  Quotes quotes = Quotes::none;
  std::vector<std::string> words;
  std::optional<std::string> word;  // quotes make one even if nothing is between them
  const auto add = [&word](char c) {
    if (!word) word.emplace();
    word->push_back(c);
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quotes == Quotes::one) {
      if (c == '\'') {
        quotes = Quotes::none;
      } else {
        add(c);
      }
    } else if (c == '\\') {
      if (++i == line.size() || line[i] == '\n') return std::nullopt;
      // Between two quotes it stands for itself before most characters.
      if (quotes == Quotes::two && std::string_view("$`\"\\").find(line[i]) == std::string::npos)
        add(c);
      add(line[i]);
    } else if (c == '"') {
      quotes = quotes == Quotes::two ? Quotes::none : Quotes::two;
      if (!word) word.emplace();
    } else if (c == '$' || c == '`' ||
               (quotes == Quotes::none &&
                std::string_view("|><;&*?~[#()\n").find(c) != std::string_view::npos)) {
      return std::nullopt;
    } else if (quotes == Quotes::none && c == '\'') {
      quotes = Quotes::one;
      if (!word) word.emplace();
    } else if (quotes == Quotes::none && (c == ' ' || c == '\t')) {
      if (word) words.push_back(*word);
      word.reset();
    } else {
      add(c);
    }
  }
  if (quotes != Quotes::none) return std::nullopt;
  if (word) words.push_back(*word);
  return words;
}

}  // namespace dlo::test
