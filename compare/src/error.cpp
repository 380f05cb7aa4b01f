#include "dlo/compare/error.hpp"

#include <algorithm>

namespace dlo::compare {
namespace {

std::string without_controls(std::string message) {
  std::replace_if(
      message.begin(), message.end(),
      [](char c) {
        const auto code = static_cast<unsigned char>(c);
        return code < 0x20 || code == 0x7f;
      },
      '?');
  return message;
}

}  // namespace

InputError::InputError(const std::string& message)
    : std::runtime_error(without_controls(message)) {}

}  // namespace dlo::compare
