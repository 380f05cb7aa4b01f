#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dlo::compare {

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

}  // namespace dlo::compare
