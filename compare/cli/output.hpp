#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace dlo::cli {

/// Formats onto the end of a text.
template <typename... Arguments>
void append(std::string& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
}

enum class Format { text, json, csv };

[[nodiscard]] const std::vector<std::string>& format_names();

/// --format and -o, which every command has.
struct OutputOptions {
  std::string format = "text";
  std::string file;

  [[nodiscard]] Format kind() const;
};

/// The format of a file's extension: "csv" of shape.csv; empty unless it is one of `formats`.
[[nodiscard]] std::string format_of_file(const std::string& file,
                                         const std::vector<std::string>& formats);

/// Writes to standard output, or to the file: to a temporary name beside it first, then renamed, so
/// that no reader ever sees half a file.
/// @throws compare::InputError naming the file if it cannot be written
void write_output(const OutputOptions& options, const std::string& content);

}  // namespace dlo::cli
