#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace dlo::compare {

/// The number that a text begins with.
template <typename Number>
struct LeadingNumber {
  Number value = 0;
  std::size_t length = 0;                         ///< of its digits; 0: none
  std::errc error = std::errc::invalid_argument;  ///< none if it is a number
};

/// The one reader of numbers: a point whatever the locale, no "+" and no blanks before it.
template <typename Number>
[[nodiscard]] LeadingNumber<Number> leading_number(std::string_view text) {
  LeadingNumber<Number> result;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.value);
  result.length = static_cast<std::size_t>(end - text.data());
  result.error = error;
  return result;
}

/// The whole of a text as a number; nothing if it is none, or out of range.
template <typename Number>
[[nodiscard]] std::optional<Number> as_number(std::string_view text) {
  const LeadingNumber<Number> number = leading_number<Number>(text);
  if (number.error != std::errc() || number.length != text.size()) return std::nullopt;
  return number.value;
}

/// A number as text shows it: 0, never -0, where it is below 1e-9 of what its kind can be in a
/// scene. That is the energy model's own error, so that nothing but rounding is left of it. JSON
/// and CSV keep it as it is.
[[nodiscard]] double shown(double value, double magnitude);

/// Of a number that leading_number() finds out of range: whether it is too small for a double, not
/// too large. @param number  digits with at most one point, and an exponent
[[nodiscard]] bool underflows(std::string_view number);

/// What is wrong with such a number, and what is allowed.
[[nodiscard]] std::string beyond_double(std::string_view number);

/// The whole of a field as a number, which may be infinite or NaN; nothing if it is none.
[[nodiscard]] std::optional<double> shape_number(std::string_view field);

}  // namespace dlo::compare
