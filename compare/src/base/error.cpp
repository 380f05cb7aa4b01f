#include "dlo/compare/error.hpp"

#include "base/display.hpp"

namespace dlo::compare {

InputError::InputError(const std::string& message) : std::runtime_error(display(message)) {}

}  // namespace dlo::compare
