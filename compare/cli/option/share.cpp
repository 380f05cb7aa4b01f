#include "option/share.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "option/command_line.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
namespace {

/// Reads a share between 0 and 1. @param of  "the length" or "the deflection", for the message
double share_of(const std::string& name, const std::string& text, const char* of,
                std::string_view number) {
  try {
    const double share = parse_fraction(std::string(number));
    if (share > 0 && share < 1) return share;
  } catch (const compare::InputError&) {
    // The error is thrown below, as for a share that is out of range.
  }
  throw compare::InputError(
      fmt::format("{} = {}: no share of {} (allowed: such as 1% or \"5% of deflection\", above 0, "
                  "below 100%)",
                  name, text, of));
}

/// Returns a tolerance in m. @throws compare::InputError if it is neither a fraction nor a length
double tolerance_m(const std::string& name, const std::string& text, double length) {
  const bool is_share = text.find_first_not_of("0123456789.eE+-%") == std::string::npos;
  double value = 0;
  try {
    value =
        is_share ? parse_fraction(text) : compare::parse_quantity(text, compare::Dimension::length);
  } catch (const compare::InputError&) {
    throw compare::InputError(
        fmt::format("{} = {}: neither a share of the length nor a length (allowed: such as 1%, "
                    "0.01, \"5% of deflection\" or \"2 mm\")",
                    name, text));
  }
  if (value > 0 && (!is_share || value < 1)) return is_share ? value * length : value;
  throw compare::InputError(
      fmt::format("{} = {}: out of range (allowed: above 0, a share of the length below 1, a "
                  "length with its unit)",
                  name, text));
}

}  // namespace

double parse_fraction(const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  return compare::parse_quantity(number, compare::Dimension::number) / (percent ? 100 : 1);
}

std::optional<double> deflection_share(const std::string& name, const std::string& text) {
  constexpr std::string_view suffix = " of deflection";
  if (!text.ends_with(suffix)) return std::nullopt;
  return share_of(name, text, "the deflection",
                  std::string_view(text).substr(0, text.size() - suffix.size()));
}

void set_growth(const std::string& name, const std::string& text,
                compare::RegressionTolerance& tolerance) {
  const std::optional<double> of_deflection = deflection_share(name, text);
  tolerance.of_deflection = of_deflection.has_value();
  tolerance.absolute = of_deflection ? *of_deflection : share_of(name, text, "the length", text);
}

void DampingOptions::add_to(Command& command) {
  command.bind("--damping", material, "--drag", air, "--quadratic-drag", quadratic);
}

compare::RodDamping DampingOptions::of(const compare::CalibratedRod& rod) const {
  return {.material = material.value_or(rod.damping.value_or(0)),
          .air = air.value_or(rod.drag.value_or(0)),
          .quadratic = quadratic.value_or(rod.quadratic_drag.value_or(0))};
}

compare::ShapeTolerance shape_tolerance(const std::string& name, const ToleranceOptions& words,
                                        double length) {
  if (words.measure != "rms" && words.measure != "max") {
    compare::refuse_choice(words.measure, {"rms", "max"});
  }
  compare::ShapeTolerance tolerance = compare::default_tolerance(length);
  if (words.allowed) {
    tolerance.by_default = false;
    tolerance.deflection_share = deflection_share(name, *words.allowed).value_or(0);
    if (!(tolerance.deflection_share > 0)) {
      tolerance.allowed_m = tolerance_m(name, *words.allowed, length);
    }
  }
  tolerance.largest = words.measure == "max";
  tolerance.part = words.min_observed_share.has_value();
  if (words.min_observed_share) tolerance.least_observed_share = *words.min_observed_share;
  return tolerance;
}

}  // namespace dlo::cli
