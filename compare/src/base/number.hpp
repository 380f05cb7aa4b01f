#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace dlo::compare {

/// Number at the beginning of a text.
template <typename Number>
struct LeadingNumber {
  Number value = 0;
  std::size_t length = 0;                         ///< number of its characters; 0: no number
  std::errc error = std::errc::invalid_argument;  ///< no error if it is a number
};

/// Reads a number at the beginning of a text, up to the first character that does not belong to it.
/// The decimal separator is a point in every locale, and neither "+" nor blanks may precede the
/// number. "inf" and "nan" are floating-point numbers. The value is 0 if there is none, or if it is
/// out of range.
template <typename Number>
[[nodiscard]] LeadingNumber<Number> leading_number(std::string_view text) {
  LeadingNumber<Number> result;
  // cppcheck-suppress invalidLifetime  // a false positive for a text that is read in a loop
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.value);
  result.length = static_cast<std::size_t>(end - text.data());
  result.error = error;
  return result;
}

/// Converts a whole text to a number; empty if the text is not a number, or out of range.
template <typename Number>
[[nodiscard]] std::optional<Number> as_number(std::string_view text) {
  const LeadingNumber<Number> number = leading_number<Number>(text);
  if (number.error != std::errc() || number.length != text.size()) return std::nullopt;
  return number.value;
}

/// Returns a number for output as text: 0, never -0, if its size is at most 1e-9 of the magnitude
/// of such quantities in the scene. That is the energy model's own error, so that the number is
/// rounding only. JSON and CSV contain the unchanged number.
[[nodiscard]] double shown(double value, double magnitude);

/// Returns the error and the allowed range of a number that a double cannot represent.
[[nodiscard]] std::string out_of_range_message(std::string_view number);

/// Converts a whole field to a number, which may be infinite or NaN and may begin with "+"; empty
/// if it is not a number. A number that is too small for a double becomes 0, one that is too large
/// becomes +infinity, whatever its sign.
[[nodiscard]] std::optional<double> shape_number(std::string_view field);

}  // namespace dlo::compare
