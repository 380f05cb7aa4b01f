#include "dlo/compare/error.hpp"

#include "dlo/compare/display.hpp"

namespace dlo::compare {

InputError::InputError(const std::string& message) : std::runtime_error(display(message)) {}

}  // namespace dlo::compare
