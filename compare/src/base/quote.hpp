#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

namespace dlo::compare {

/// A text of characters that XML 1.0 has: control characters become blanks, and what is no UTF-8,
/// U+FFFE and U+FFFF become U+FFFD.
[[nodiscard]] std::string xml_text(const std::string& text);

/// xml_text() as HTML and XML show it, in elements and in attributes.
[[nodiscard]] std::string escape_markup(const std::string& text);

/// A field of a CSV line, quoted where it has to be; but for tabs and line breaks as display().
[[nodiscard]] std::string csv_field(const std::string& text);

/// A number as every CSV that dlo writes has it, never -0; nothing for NaN and infinity.
/// @param digits  significant ones, 1 to 17
[[nodiscard]] std::string csv_number(double value, int digits = 10);

/// A text as a TOML basic string, in quotes; control characters (U+0000 to U+001F, U+007F to
/// U+009F) are escaped.
[[nodiscard]] std::string toml_string(const std::string& text);

/// A word as a shell takes it, in quotes where it needs them, those of bash for one that holds
/// control characters or no UTF-8.
[[nodiscard]] std::string shell_word(const std::string& word);

/// A piece of a file for a message: short, printable.
[[nodiscard]] std::string printable_piece(std::string_view piece);

/// The same in quotes.
[[nodiscard]] std::string quoted_piece(std::string_view piece);

/// Formats onto the end of a text.
template <typename... Arguments>
void append(std::string& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
}

}  // namespace dlo::compare
