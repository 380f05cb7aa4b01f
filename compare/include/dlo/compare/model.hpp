#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// The models that solve a scene.
enum class Model {
  energy,  ///< minimiser of the continuous rod's energy
  chain,   ///< minimiser over the force model's polygon
  exact,   ///< boundary value problem of the rod, shot with GSL
  force,   ///< the paper's model, stepped to rest
};

/// Their names, as options and files spell them.
[[nodiscard]] const std::vector<std::string>& model_names();
/// The name of a model.
[[nodiscard]] const char* to_string(Model model);
/// @throws InputError if no model has this name
[[nodiscard]] Model model_from(const std::string& name);

}  // namespace dlo::compare
