#pragma once

#include <string>
#include <string_view>

namespace dlo::compare {

/// A text as HTML and XML show it, in elements and in attributes; control characters, most of which
/// XML 1.0 has no way to write, become blanks, and what is no UTF-8 becomes U+FFFD.
[[nodiscard]] std::string escape_markup(const std::string& text);

/// A field of a CSV line, quoted where it has to be.
[[nodiscard]] std::string csv_field(const std::string& text);

/// A number as every CSV that dlo writes has it, never -0; nothing for NaN and infinity.
/// @param digits  significant ones, 1 to 17
[[nodiscard]] std::string csv_number(double value, int digits = 10);

/// A text as a TOML basic string, in quotes; control characters are escaped.
[[nodiscard]] std::string toml_string(const std::string& text);

/// A word as a shell takes it, in quotes where it needs them.
[[nodiscard]] std::string shell_word(const std::string& word);

/// A piece of a file for a message: short, in quotes, printable.
[[nodiscard]] std::string quoted_piece(std::string_view piece);

}  // namespace dlo::compare
