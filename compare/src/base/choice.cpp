#include "dlo/compare/choice.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

void refuse_choice(const std::string& name, const std::vector<std::string>& allowed) {
  throw InputError(
      fmt::format("unknown choice \"{}\" (allowed: {})", name, fmt::join(allowed, ", ")));
}

std::string one_of(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

}  // namespace dlo::compare
