#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dlo::compare {

/// Returns a text as UTF-8: bytes that belong to no well-formed sequence (RFC 3629) become U+FFFD.
/// File names are bytes, but JSON, TOML and XML are text.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// Returns a text as a JSON string, in quotes, as valid_utf8().
[[nodiscard]] std::string json_string(std::string_view text);

/// Returns a name for one line of text: as valid_utf8(), with "?" for each control character
/// (U+0000 to U+001F, U+007F to U+009F), so that no name breaks a line or controls a terminal.
[[nodiscard]] std::string display(std::string_view text);

/// Returns the number of bytes of the control character at a position of valid UTF-8; 0: none.
[[nodiscard]] std::size_t control_character_length(std::string_view text, std::size_t at);

/// Returns a text without the given characters at its begin and end.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view characters = " ");

/// Returns ", did you mean X?" for messages, X the word that was probably meant: the first of those
/// with the smallest Levenshtein distance, if that is at most two and less than half of the length
/// of the written word; else an empty text.
[[nodiscard]] std::string did_you_mean(std::string_view written,
                                       const std::vector<std::string>& words);

/// Replaces placeholders by their values. Inserted values are not searched for placeholders.
/// @param values  placeholders, none empty, and their values
[[nodiscard]] std::string replace_placeholders(
    std::string_view text, const std::vector<std::pair<std::string_view, std::string>>& values);

/// Wraps a text into lines of at most `width` bytes, all but the first indented by `indent` blanks;
/// a longer word is not divided. The first line is assumed to follow `indent` bytes of other text.
/// Blanks and line breaks between words become one blank. The last line has no line break.
[[nodiscard]] std::string wrap(const std::string& text, std::size_t indent, std::size_t width = 80);

/// Largest nesting depth of TOML and JSON. Parsers make a nested table of every part of a dotted
/// key and free them by recursion, so that a file must not determine the depth of the stack. Scenes
/// and baselines have at most four levels.
inline constexpr int deepest_nesting = 32;

/// Checks the limits of a TOML text.
/// @throws InputError that names file and line if brackets are nested deeper than deepest_nesting,
/// a key has more dotted parts, or a number is too large or too small for a double
void require_toml_limits(std::string_view text, const std::string& file);

}  // namespace dlo::compare
