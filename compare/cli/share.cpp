#include "share.hpp"

#include <fmt/format.h>

#include <string>

#include "dlo/compare/error.hpp"
#include "dlo/compare/quantity.hpp"

namespace dlo::cli {
namespace {

/// Zero for what is not a number.
double share_from(const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  try {
    return compare::parse_quantity(number, compare::Dimension::number) / (percent ? 100 : 1);
  } catch (const compare::InputError&) {
    return 0;
  }
}

}  // namespace

CLI::Validator share_of_length() {
  return {[](std::string& text) {
            const double share = share_from(text);
            if (!(share > 0 && share < 1)) {
              return fmt::format("{} is no share of the length (allowed: 0.1% or 0.001, > 0, < 1)",
                                 text);
            }
            text = fmt::format("{:.17g}", share);
            return std::string();
          },
          "SHARE"};
}

}  // namespace dlo::cli
