#include "option/share.hpp"

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/error.hpp"
#include "option/command_line.hpp"
#include "toml/quantity.hpp"

namespace dlo::cli {
namespace {

/// Reads a fraction such as "1%" or 0.01. @throws compare::InputError if the text is no number
double share_from(const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  return compare::parse_quantity(number, compare::Dimension::number) / (percent ? 100 : 1);
}

/// Returns a check for fractions. @param of       " of ...", or an empty string
/// @param allowed  allowed values, in words
CLI::Validator share_that(std::function<bool(double)> holds, std::string of, std::string allowed) {
  const auto read = [holds = std::move(holds), of = std::move(of),
                     allowed = std::move(allowed)](std::string& text) {
    std::string problem;
    try {
      const double share = share_from(text);
      if (holds(share)) {
        text = fmt::format("{:.17g}", share);
        return std::string();
      }
    } catch (const compare::InputError& error) {
      problem = fmt::format(", {}", error.what());
    }
    return fmt::format("{} is no share{}{} (allowed: {})", text, of, problem, allowed);
  };
  return {read, ""};
}

/// Returns a tolerance in m. @throws compare::InputError if it is neither a fraction nor a length
double tolerance_m(const std::string& name, const std::string& text, double length) {
  double value = 0;
  try {
    value = share_from(text);
    if (value > 0 && value < 1) return value * length;
  } catch (const compare::InputError&) {
    try {
      value = text.ends_with('%') ? 0 : compare::parse_quantity(text, compare::Dimension::length);
    } catch (const compare::InputError&) {
      throw compare::InputError(
          fmt::format("{} = {}: neither a share of the length nor a length (allowed: such as 1%, "
                      "0.01, \"5% of deflection\" or \"2 mm\")",
                      name, text));
    }
    if (value > 0) return value;
  }
  throw compare::InputError(
      fmt::format("{} = {}: out of range (allowed: above 0, a share of the length below 1, a "
                  "length with its unit)",
                  name, text));
}

}  // namespace

CLI::Validator share_of_length() {
  return share_that([](double share) { return share > 0 && share < 1; }, " of the length",
                    "0.1% or 0.001, > 0, < 1");
}

CLI::Validator share_up_to(double high) {
  return share_that([high](double share) { return share >= 0 && share <= high; }, "",
                    fmt::format("1% or 0.01, 0 to {:g}", high));
}

std::optional<double> deflection_share(const std::string& name, const std::string& text) {
  constexpr std::string_view suffix = " of deflection";
  if (!text.ends_with(suffix)) return std::nullopt;
  try {
    const double share = share_from(text.substr(0, text.size() - suffix.size()));
    if (share > 0 && share < 1) return share;
  } catch (const compare::InputError&) {
    // The error is thrown below, as for a fraction that is out of range.
  }
  throw compare::InputError(
      fmt::format("{} = {}: no share of the deflection (allowed: such as \"5% of deflection\", "
                  "above 0, below 100%)",
                  name, text));
}

void set_growth(const std::string& name, const std::string& text,
                compare::RegressionTolerance& tolerance) {
  const std::optional<double> of_deflection = deflection_share(name, text);
  tolerance.of_deflection = of_deflection.has_value();
  std::string share = text;
  const std::string problem = of_deflection ? "" : share_of_length()(share);
  if (!problem.empty()) {
    throw compare::InputError(fmt::format("{}: {}; or \"5% of deflection\"", name, problem));
  }
  tolerance.absolute = of_deflection ? *of_deflection : share_from(share);
}

void DampingOptions::add_to(Command& command) {
  command.bind("--damping", material, "--drag", air, "--quadratic-drag", quadratic);
}

compare::RodDamping DampingOptions::of(const compare::CalibratedRod& rod) const {
  return {.material = material.value_or(rod.damping.value_or(0)),
          .air = air.value_or(rod.drag.value_or(0)),
          .quadratic = quadratic.value_or(rod.quadratic_drag.value_or(0))};
}

compare::ShapeTolerance shape_tolerance(const std::string& name, const ToleranceWords& words,
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
  tolerance.part = words.min_seen.has_value();
  if (words.min_seen) tolerance.least_seen_share = *words.min_seen;
  return tolerance;
}

}  // namespace dlo::cli
