#pragma once

#include <cstddef>
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

/// Place of a name among those of all choices. @throws InputError if it is none of them
[[nodiscard]] std::size_t choice_index(const std::string& name,
                                       const std::vector<std::string>& names);

/// The value of an enumeration by its name. @param names  of all its values, in their order
/// @throws InputError if there is no such name
template <typename Choice>
[[nodiscard]] Choice choice_from(const std::string& name, const std::vector<std::string>& names) {
  return static_cast<Choice>(choice_index(name, names));
}

}  // namespace dlo::compare
