#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// The word that was probably meant: the first of those with the smallest Levenshtein distance, if
/// that is at most two and less than half of the written word; else empty.
[[nodiscard]] std::string nearest_word(std::string_view written,
                                       const std::vector<std::string>& words);

/// ", did you mean X?" or nothing, for messages.
[[nodiscard]] std::string did_you_mean(std::string_view written,
                                       const std::vector<std::string>& words);

}  // namespace dlo::compare
