#pragma once

#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "../helpers.hpp"
#include "foreign/child_process.hpp"

namespace dlo::test {

/// Returns the words into which sh(1) splits a line by blanks, quotes and backslashes; nothing if
/// the line has anything else that a shell acts on, such as pipes, variables and patterns.
inline std::optional<std::vector<std::string>> shell_words(const std::string& line) {
  static const std::regex quoted(R"('[^']*'|"(\\[^\n]|[^"\\$`])*"|\\[^\n])");
  const std::string others = std::regex_replace(line, quoted, "x");
  if (others.find_first_of("'\"\\$`|><;&*?~[#()\n") != std::string::npos) return std::nullopt;
  if (others.find_first_not_of(" \t") == std::string::npos) return std::vector<std::string>();
  return compare::command_words(line, "shell_words");
}

}  // namespace dlo::test
