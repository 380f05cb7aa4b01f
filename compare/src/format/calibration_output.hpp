#pragma once

#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/material_fit.hpp"
#include "record/field.hpp"

namespace dlo::cli {

/// Name of a fitted number in keys, and its unit as it follows there, such as "_Pa"; may be empty.
struct Key {
  std::string name;
  std::string unit;

  [[nodiscard]] std::string text() const { return name + unit; }
};

/// Returns the key of the stiffness: of E, or of EI if the rod is given by EI.
[[nodiscard]] Key stiffness_key(const compare::Scene& scene);
[[nodiscard]] Key mass_parameter_key(const compare::Scene& scene);
[[nodiscard]] Key torsion_key();

/// One of the fitted numbers of a material.
struct ShownValue {
  compare::NamedValue quantity;  ///< quantity and value of the scene, for text
  Key key;
  std::string prefix;  ///< prefix of the keys of the uncertainty and the interval
  compare::FittedValue value;
};

/// Returns the fitted numbers, with the names and values of the first scene: E or EI, then those of
/// density, GJ and GJ / EI that were fitted.
[[nodiscard]] std::vector<ShownValue> fitted_values(const compare::Calibration& report);

/// Returns "95 %: 1.2 to 1.3"; an open end is "...".
[[nodiscard]] std::string interval_text(const compare::FittedValue& value);

/// Returns the options of an alternative fit, as they are given on the command line.
[[nodiscard]] std::string option_words(const compare::FitAlternative& alternative);

/// Returns an object for each of the chains that come nearest to a rod, with its segments and
/// joints.
[[nodiscard]] compare::Json chains_json(const std::vector<compare::ChainSprings>& chains);

/// Returns the results for --calibrated. If the rod is given by E, it is also a materials file with
/// the material "calibrated".
/// @throws compare::InputError if E or a fitted density is not identified and no shapes were
/// predicted, or the rod is given by EI and a density or the reverse
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

/// A value, and the comment that states its interval.
struct WrittenValue {
  double value = 0;
  std::string interval;
};

/// Adds stiffness, mass and their source: lines of [rod], or a [[material]].
/// @throws compare::InputError if the scene has one of EI and mass per length, and not the other
void add_rod_lines(std::string& out, const compare::Scene& scene, const WrittenValue& stiffness,
                   const WrittenValue& mass_parameter, const std::string& source);

}  // namespace dlo::cli
