#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dlo::compare {

/// A text as UTF-8: what belongs to no well-formed sequence (RFC 3629) becomes U+FFFD.
/// Names of files are bytes; JSON, TOML and XML are text.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// A text as a JSON string, in quotes, as valid_utf8().
[[nodiscard]] std::string json_string(std::string_view text);

/// A name as one line of text shows it: valid_utf8(), and each control character (U+0000 to U+001F,
/// U+007F to U+009F) is a "?", so that no name breaks a line or steers a terminal.
[[nodiscard]] std::string display(std::string_view text);

/// Bytes of the control character that stands at a place of a text of valid UTF-8; 0: none.
[[nodiscard]] std::size_t control_bytes(std::string_view text, std::size_t at);

/// The word that was probably meant: the first of those with the smallest Levenshtein distance, if
/// that is at most two and less than half of the written word; else empty.
[[nodiscard]] std::string nearest_word(std::string_view written,
                                       const std::vector<std::string>& words);

/// ", did you mean X?" or nothing, for messages.
[[nodiscard]] std::string did_you_mean(std::string_view written,
                                       const std::vector<std::string>& words);

/// A text in which each of these places has what belongs there, which is not looked at again.
/// @param values  places, none empty, and their values
[[nodiscard]] std::string with_places(
    std::string_view text, const std::vector<std::pair<std::string_view, std::string>>& values);

/// Lines of at most `width`, all but the first indented.
[[nodiscard]] std::string wrap(const std::string& text, std::size_t indent, std::size_t width = 80);

/// Parsers make a table within a table of every part of a dotted key and free them by recursion: a
/// file may not decide how deep the stack gets. No scene or baseline has more than four levels.
inline constexpr int deepest_nesting = 32;

/// @throws InputError naming file and line if brackets are nested deeper than deepest_nesting, a
/// key has more dotted parts, or a number is too large or too small for a double
void require_toml_limits(std::string_view text, const std::string& file);

/// @throws InputError naming file and line if brackets are nested deeper than deepest_nesting, or
/// if there are more than `most_values` values
void require_json_limits(std::string_view text, const std::string& file, long most_values);

}  // namespace dlo::compare
