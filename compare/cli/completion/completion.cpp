#include "completion/completion.hpp"

#include <algorithm>

#include "dlo/compare/material.hpp"

namespace dlo::cli {

Completion completion_of(const OptionText& text) {
  if (!text.choices.empty()) return {Offer::words, text.choices};
  if (text.value == "MATERIAL") {
    std::vector<std::string> names;
    for (const compare::Material& material : compare::materials()) names.push_back(material.name);
    return {Offer::words, names};
  }
  const auto is = [&text](const char* what) {
    return text.value.starts_with(what) || text.names.front() == what;
  };
  if (is("SCENE")) return {Offer::scenes, {}};
  if (is("FILE")) return {Offer::files, {}};
  if (text.value == "DIR") return {Offer::folders, {}};
  const bool is_flag = text.value.empty() && text.names.front().starts_with('-');
  return {is_flag ? Offer::nothing : Offer::own, {}};
}

std::string short_description(const std::string& description) {
  std::size_t end = description.size();
  for (const char* const mark : {"; ", ". ", ": ", " ("}) {
    end = std::min(end, description.find(mark));
  }
  return description.substr(0, end);
}

}  // namespace dlo::cli
