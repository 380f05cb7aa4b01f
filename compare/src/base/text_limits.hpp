#pragma once

#include <string>
#include <string_view>

namespace dlo::compare {

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
