#include "base/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dlo::compare {
namespace {

/// Returns the power of ten of a number's first nonzero digit, plus one if the digit is before the
/// point. The number has digits with at most one point; a sign and an exponent are optional.
long decimal_exponent(std::string_view number) {
  const std::size_t mark = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, mark);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::size_t first = std::min(digits.find_first_of("123456789"), digits.size());
  const long place = static_cast<long>(point) - static_cast<long>(first);
  std::string_view exponent = number.substr(std::min(mark + 1, number.size()));
  if (exponent.starts_with('+')) exponent.remove_prefix(1);
  constexpr long largest_exponent = 1'000'000'000;
  auto [value, length, error] = leading_number<long>(exponent);
  if (error == std::errc::result_out_of_range)
    value = exponent.front() == '-' ? -largest_exponent : largest_exponent;
  return std::clamp(value, -largest_exponent, largest_exponent) + place;
}

/// Shortens a number for a message, because it may have thousands of digits.
std::string shortened(std::string_view number) {
  constexpr std::size_t longest = 40;
  return fmt::format("{}{}", number.substr(0, longest), number.size() > longest ? "..." : "");
}

}  // namespace

double shown(double value, double magnitude) {
  constexpr double error = 1e-9;
  return std::abs(value) <= error * magnitude ? 0.0 : value;
}

std::string out_of_range_message(std::string_view number) {
  return decimal_exponent(number) < 0
             ? fmt::format("{} is too small (allowed: 0, or 2.3e-308 and more)", shortened(number))
             : fmt::format("{} is too large (allowed: up to 1.7e308)", shortened(number));
}

std::optional<double> shape_number(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  const auto [value, length, error] = leading_number<double>(field);
  if (length != field.size() || field.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return decimal_exponent(field) < 0 ? 0.0 : INFINITY;
  if (error != std::errc()) return std::nullopt;
  return value;
}

}  // namespace dlo::compare
