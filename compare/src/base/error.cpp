#include "dlo/compare/error.hpp"

#include "base/display.hpp"

namespace dlo::compare {

InputError::InputError(const std::string& message) : ResultError(display(message)) {}

InputError::InputError(const std::string& where, const std::string& key, const std::string& problem)
    : ResultError(display(where + ": " + key + problem)),
      key_(display(key)),
      problem_(display(problem)) {}

}  // namespace dlo::compare
