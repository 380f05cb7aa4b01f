#include "dlo/compare/model.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> names = {"energy", "chain", "exact", "force"};
  return names;
}

const char* to_string(Model model) {
  return model_names()[static_cast<std::size_t>(model)].c_str();
}

Model model_from(const std::string& name) {
  const auto& names = model_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError(
        fmt::format("unknown model \"{}\" (allowed: {})", name, fmt::join(names, ", ")));
  }
  return static_cast<Model>(found - names.begin());
}

}  // namespace dlo::compare
