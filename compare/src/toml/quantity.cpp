#include "toml/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>

#include "base/number.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};

/// Name of a dimension, its units, SI first, and the largest magnitude of a number in SI units.
struct DimensionUnits {
  std::string_view name;
  Unit units[6];  // those without a name do not exist
  double largest = 1e30;
};

constexpr double degree_in_radians = std::numbers::pi / 180;
constexpr double unlimited = std::numeric_limits<double>::max();
/// In the order of Dimension. Clocks count 1.8e9 s since 1970; curvatures and twists are at most
/// the reciprocal of the smallest radius of a helix.
constexpr DimensionUnits dimensions[] = {
    {"number", {}},
    {"length", {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}}, 1e6},
    {"angle", {{"rad", 1}, {"deg", degree_in_radians}}},
    {"pressure", {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"N/mm^2", 1e6}}, unlimited},
    {"density", {{"kg/m^3", 1}, {"kg/dm^3", 1e3}, {"g/cm^3", 1e3}}},
    {"force", {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}}},
    {"torque", {{"N m", 1}, {"mN m", 1e-3}, {"N mm", 1e-3}, {"kN m", 1e3}}},
    {"force_per_length", {{"N/m", 1}, {"mN/m", 1e-3}, {"kN/m", 1e3}, {"N/mm", 1e3}}},
    {"acceleration", {{"m/s^2", 1}}},
    {"velocity", {{"m/s", 1}, {"mm/s", 1e-3}, {"km/h", 1 / 3.6}}},
    {"curvature", {{"1/m", 1}, {"1/cm", 1e2}, {"1/mm", 1e3}}, 1e9},
    {"foundation", {{"N/m^2", 1}, {"N/mm^2", 1e6}}},
    {"section_stiffness",
     {{"N m^2", 1}, {"mN m^2", 1e-3}, {"kN m^2", 1e3}, {"N cm^2", 1e-4}, {"N mm^2", 1e-6}},
     unlimited},
    {"joint_stiffness",
     {{"N m/rad", 1},
      {"N m", 1},
      {"mN m/rad", 1e-3},
      {"N mm/rad", 1e-3},
      {"N mm", 1e-3},
      {"N m/deg", 1 / degree_in_radians}}},
    {"mass", {{"kg", 1}, {"g", 1e-3}}},
    {"mass_per_length", {{"kg/m", 1}, {"g/m", 1e-3}, {"g/cm", 1e-1}}},
    {"twist", {{"rad/m", 1}, {"deg/m", degree_in_radians}, {"1/m", 1}}, 1e9},
    {"time", {{"s", 1}, {"ms", 1e-3}, {"min", 60}}, 1e12},
    {"frequency", {{"Hz", 1}, {"kHz", 1e3}}}};

const DimensionUnits& units_of(Dimension dimension) {
  return dimensions[static_cast<std::size_t>(dimension)];
}

std::span<const Unit> units(Dimension dimension) {
  const auto& all = units_of(dimension).units;
  const auto* const end = std::ranges::find(all, std::string_view(), &Unit::name);
  return {std::begin(all), end};
}

/// Returns a unit in the spelling of the tables above: "*" and middle dots become blanks, raised
/// digits "^2" and "^3", the micro sign "u" and the degree sign "deg".
std::string plain_spelling(std::string_view written) {
  return replace_placeholders(written, {{"*", " "},
                                        {"\xc2\xb7", " "},
                                        {"\xe2\x8b\x85", " "},
                                        {"\xc2\xb2", "^2"},
                                        {"\xc2\xb3", "^3"},
                                        {"\xc2\xb5", "u"},
                                        {"\xce\xbc", "u"},
                                        {"\xc2\xb0", "deg"}});
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

std::optional<Dimension> dimension_named(std::string_view name) {
  const auto* const found = std::ranges::find(dimensions, name, &DimensionUnits::name);
  if (found == std::end(dimensions)) return std::nullopt;
  return static_cast<Dimension>(found - std::begin(dimensions));
}

std::vector<std::string> unit_names(Dimension dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : units(dimension)) names.emplace_back(unit.name);
  return names;
}

std::string known_units(Dimension dimension) {
  return fmt::format("{}", fmt::join(unit_names(dimension), ", "));
}

std::string magnitude_problem(double value, Dimension dimension) {
  const double largest = units_of(dimension).largest;
  if (std::abs(value) <= largest) return {};
  return fmt::format("out of range (allowed: magnitudes up to {:g} in SI units)", largest);
}

double parse_quantity(std::string_view text, Dimension dimension) {
  const auto refuse_text = [&] {
    const std::string list = known_units(dimension);
    if (list.empty()) throw InputError(fmt::format("\"{}\" is not a number", text));
    throw UnitError(fmt::format("\"{}\" is not a number with a unit (allowed: {})", text, list));
  };
  const std::size_t start = text.find_first_not_of(" \t");
  if (start == std::string_view::npos) refuse_text();
  std::string_view rest = text.substr(start);
  if (rest.front() == '+') rest.remove_prefix(1);
  const auto [value, length, error] = leading_number<double>(rest);
  if (error == std::errc::result_out_of_range) {
    throw InputError(out_of_range_message(rest.substr(0, length)));
  }
  if (error != std::errc()) refuse_text();
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
    throw UnitError(
        fmt::format("\"{}\" lacks a unit (allowed: {}; a bare number without quotes is SI)", text,
                    known_units(dimension)));
  }
  const std::string plain = plain_spelling(name);
  for (const Unit& unit : units(dimension)) {
    if (names(plain, unit.name)) return value * unit.factor;
  }
  throw UnitError(fmt::format("unknown unit \"{}\" in \"{}\" (allowed: {})", name, text,
                              units(dimension).empty() ? "none" : known_units(dimension)));
}

}  // namespace dlo::compare
