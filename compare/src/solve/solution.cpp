#include "dlo/compare/solution.hpp"

#include "base/words.hpp"

namespace dlo::compare {

const std::vector<std::string>& model_names() {
  static const std::vector<std::string> names = {"energy", "chain", "exact", "force"};
  return names;
}

const char* to_string(Model model) {
  return model_names()[static_cast<std::size_t>(model)].c_str();
}

Model model_from(const std::string& name) { return choice_from<Model>(name, model_names()); }

}  // namespace dlo::compare
