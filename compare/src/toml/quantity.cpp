#include "toml/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};

constexpr Unit lengths[] = {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}};
constexpr Unit angles[] = {{"rad", 1}, {"deg", std::numbers::pi / 180}};
constexpr Unit pressures[] = {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"N/mm^2", 1e6}};
constexpr Unit densities[] = {{"kg/m^3", 1}, {"kg/dm^3", 1e3}, {"g/cm^3", 1e3}};
constexpr Unit forces[] = {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}};
constexpr Unit torques[] = {{"N m", 1}, {"mN m", 1e-3}, {"N mm", 1e-3}, {"kN m", 1e3}};
constexpr Unit forces_per_length[] = {{"N/m", 1}, {"mN/m", 1e-3}, {"kN/m", 1e3}, {"N/mm", 1e3}};
constexpr Unit accelerations[] = {{"m/s^2", 1}};
constexpr Unit velocities[] = {{"m/s", 1}, {"mm/s", 1e-3}, {"km/h", 1 / 3.6}};
constexpr Unit curvatures[] = {{"1/m", 1}, {"1/cm", 1e2}, {"1/mm", 1e3}};
constexpr Unit foundations[] = {{"N/m^2", 1}, {"N/mm^2", 1e6}};
constexpr Unit section_stiffnesses[] = {
    {"N m^2", 1}, {"mN m^2", 1e-3}, {"kN m^2", 1e3}, {"N cm^2", 1e-4}, {"N mm^2", 1e-6}};
constexpr Unit joint_stiffnesses[] = {{"N m/rad", 1},     {"N m", 1},
                                      {"mN m/rad", 1e-3}, {"N mm/rad", 1e-3},
                                      {"N mm", 1e-3},     {"N m/deg", 180 / std::numbers::pi}};
constexpr Unit masses[] = {{"kg", 1}, {"g", 1e-3}};
constexpr Unit masses_per_length[] = {{"kg/m", 1}, {"g/m", 1e-3}, {"g/cm", 1e-1}};
constexpr Unit twists[] = {{"rad/m", 1}, {"deg/m", std::numbers::pi / 180}, {"1/m", 1}};
constexpr Unit times[] = {{"s", 1}, {"ms", 1e-3}, {"min", 60}};
constexpr Unit frequencies[] = {{"Hz", 1}, {"kHz", 1e3}};

std::span<const Unit> units(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return lengths;
    case Dimension::angle:
      return angles;
    case Dimension::pressure:
      return pressures;
    case Dimension::density:
      return densities;
    case Dimension::force:
      return forces;
    case Dimension::torque:
      return torques;
    case Dimension::force_per_length:
      return forces_per_length;
    case Dimension::acceleration:
      return accelerations;
    case Dimension::velocity:
      return velocities;
    case Dimension::curvature:
      return curvatures;
    case Dimension::foundation:
      return foundations;
    case Dimension::section_stiffness:
      return section_stiffnesses;
    case Dimension::joint_stiffness:
      return joint_stiffnesses;
    case Dimension::mass:
      return masses;
    case Dimension::mass_per_length:
      return masses_per_length;
    case Dimension::twist:
      return twists;
    case Dimension::time:
      return times;
    case Dimension::frequency:
      return frequencies;
    case Dimension::number:
      break;
  }
  return {};
}

/// Returns a unit in the spelling of the tables above: "*" and middle dots become blanks, raised
/// digits "^2" and "^3", the micro sign "u" and the degree sign "deg".
std::string plain_spelling(std::string_view written) {
  constexpr std::pair<std::string_view, std::string_view> spellings[] = {
      {"*", " "},         {"\xc2\xb7", " "}, {"\xe2\x8b\x85", " "}, {"\xc2\xb2", "^2"},
      {"\xc2\xb3", "^3"}, {"\xc2\xb5", "u"}, {"\xce\xbc", "u"},     {"\xc2\xb0", "deg"}};
  std::string plain;
  while (!written.empty()) {
    const auto* const found =
        std::find_if(std::begin(spellings), std::end(spellings),
                     [&](const auto& spelling) { return written.starts_with(spelling.first); });
    if (found != std::end(spellings)) {
      plain += found->second;
      written.remove_prefix(found->first.size());
    } else {
      plain += written.front();
      written.remove_prefix(1);
    }
  }
  return plain;
}

/// Whether a text is the unit's name, or the name without its blank: "Nm". A name with an
/// additional blank, as in "m m", would be another unit.
bool names(std::string_view plain, std::string_view unit) {
  if (plain == unit) return true;
  std::string joined(unit);
  std::erase(joined, ' ');
  return plain == joined;
}

}  // namespace

std::vector<std::string> unit_names(Dimension dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : units(dimension)) names.emplace_back(unit.name);
  return names;
}

std::string known_units(Dimension dimension) {
  return fmt::format("{}", fmt::join(unit_names(dimension), ", "));
}

namespace {

double largest_magnitude(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return 1e6;  // m, as for coordinates of shape files
    case Dimension::curvature:
    case Dimension::twist:
      return 1e9;  // 1/m, the reciprocal of the smallest radius of a helix
    case Dimension::time:
      return 1e12;  // s; clocks count 1.8e9 s since 1970
    case Dimension::pressure:
    case Dimension::section_stiffness:
      return std::numeric_limits<double>::max();
    default:
      return 1e30;
  }
}

}  // namespace

std::string magnitude_problem(double value, Dimension dimension) {
  const double largest = largest_magnitude(dimension);
  if (std::abs(value) <= largest) return {};
  return fmt::format("out of range (allowed: magnitudes up to {:g} in SI units)", largest);
}

double parse_quantity(std::string_view text, Dimension dimension) {
  const auto not_a_number = [&] {
    const std::string list = known_units(dimension);
    return InputError(
        list.empty() ? fmt::format("\"{}\" is not a number", text)
                     : fmt::format("\"{}\" is not a number with a unit (allowed: {})", text, list));
  };
  const std::size_t start = text.find_first_not_of(" \t");
  if (start == std::string_view::npos) throw not_a_number();
  std::string_view rest = text.substr(start);
  if (rest.front() == '+') rest.remove_prefix(1);
  const auto [value, length, error] = leading_number<double>(rest);
  if (error == std::errc::result_out_of_range) {
    throw InputError(beyond_double(rest.substr(0, length)));
  }
  if (error != std::errc()) throw not_a_number();
  rest.remove_prefix(length);
  if (rest.size() > 1 && rest[0] == ',' && rest[1] >= '0' && rest[1] <= '9') {
    throw InputError(fmt::format("\"{}\" has a comma (allowed: a decimal point)", text));
  }
  const std::size_t unit_start = rest.find_first_not_of(" \t");
  std::string_view name =
      unit_start == std::string_view::npos ? std::string_view() : rest.substr(unit_start);
  while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.remove_suffix(1);
  if (!std::isfinite(value)) throw InputError(fmt::format("\"{}\" is not finite", text));
  if (name.empty()) {
    if (dimension == Dimension::number) return value;
    throw InputError(
        fmt::format("\"{}\" lacks a unit (allowed: {}; a bare number without quotes is SI)", text,
                    known_units(dimension)));
  }
  const std::string plain = plain_spelling(name);
  for (const Unit& unit : units(dimension)) {
    if (names(plain, unit.name)) return value * unit.factor;
  }
  throw InputError(fmt::format("unknown unit \"{}\" in \"{}\" (allowed: {})", name, text,
                               units(dimension).empty() ? "none" : known_units(dimension)));
}

}  // namespace dlo::compare
