#pragma once

#include <string>
#include <string_view>

namespace dlo::compare {

/// Parsers make a table within a table of every part of a dotted key and free them by recursion: a
/// file may not decide how deep the stack gets. No scene or baseline has more than four levels.
inline constexpr int deepest_nesting = 32;

/// @throws InputError naming file and line if brackets are nested deeper than deepest_nesting, or a
/// key has more dotted parts
void require_shallow_toml(std::string_view text, const std::string& file);

/// @throws InputError naming file and line if brackets are nested deeper than deepest_nesting, or
/// if there are more values than a shape of the most points has a use for
void require_shallow_json(std::string_view text, const std::string& file);

}  // namespace dlo::compare
