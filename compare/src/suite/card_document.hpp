#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "suite/card.hpp"

namespace dlo::compare {

/// Cards as a document with schema dlo/card/1; an error or order that is not known is NaN.
[[nodiscard]] nlohmann::ordered_json cards_json(const std::vector<Card>& cards);

/// Cards of such a document. @param file  its name, for messages
/// @throws InputError naming the file and what is wrong
[[nodiscard]] std::vector<Card> parse_cards(const std::string& text, const std::string& file);

/// A file of them. @throws InputError likewise, or if it cannot be read
[[nodiscard]] std::vector<Card> load_cards(const std::string& path);

}  // namespace dlo::compare
