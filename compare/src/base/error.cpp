#include "dlo/compare/error.hpp"

#include <fmt/format.h>

#include <cstddef>

#include "base/text.hpp"

namespace dlo::compare {
namespace {

/// Returns the message as one line (display()). If the message is longer than 4096 bytes, for
/// example because it quotes a very long value, its middle is replaced by the number of omitted
/// bytes; the file and the key at the beginning and the allowed values at the end remain.
std::string shortened(const std::string& message) {
  constexpr std::size_t longest = 4096;
  constexpr std::size_t begin = 512;
  constexpr std::size_t end = 512;
  if (message.size() <= longest) return display(message);
  return display(fmt::format("{} ... ({} bytes) ... {}", message.substr(0, begin),
                             message.size() - begin - end, message.substr(message.size() - end)));
}

}  // namespace

InputError::InputError(const std::string& message) : ResultError(shortened(message)) {}

InputError::InputError(const std::string& where, const std::string& key, const std::string& problem)
    : ResultError(shortened(where + ": " + key + problem)),
      key_(shortened(key)),
      problem_(shortened(problem)) {}

}  // namespace dlo::compare
