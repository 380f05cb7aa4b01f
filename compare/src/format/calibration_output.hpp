#pragma once

#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/material_fit.hpp"
#include "record/field.hpp"

namespace dlo::cli {

/// A fitted number's name and unit in keys.
struct Key {
  std::string name;
  std::string unit;

  [[nodiscard]] std::string text() const { return name + unit; }
};

/// Of a rod that is given by its material, or by EI and its mass.
[[nodiscard]] Key stiffness_key(const compare::Scene& scene);
[[nodiscard]] Key heaviness_key(const compare::Scene& scene);
[[nodiscard]] Key torsion_key();

/// One of the numbers of a material that were fitted.
struct ShownValue {
  compare::NamedValue said;  ///< by the scene, as text names it
  Key key;
  std::string prefix;  ///< of the keys of its uncertainty and its interval
  compare::FittedValue value;
};

/// Of the first scene, in order: the first one is E, or EI.
[[nodiscard]] std::vector<ShownValue> fitted_values(const compare::Calibration& report);

/// "95 %: 1.2 to 1.3"; an open side is "...".
[[nodiscard]] std::string interval_text(const compare::FittedValue& value);

/// Options as the command line has them.
[[nodiscard]] std::string option_words(const compare::FitAlternative& alternative);

/// Joints of the chains that come nearest to a rod.
[[nodiscard]] std::string chains_text(const std::vector<compare::ChainSprings>& chains);
[[nodiscard]] compare::Json chains_json(const std::vector<compare::ChainSprings>& chains);

/// What was found, for --calibrated; of a rod by E also a materials file with "calibrated".
/// @throws compare::InputError if E is not identified and no shapes were predicted, or the rod is
/// given by EI and a density or the reverse
[[nodiscard]] std::string material_toml(const compare::Calibration& report);

/// Value with the comment that states its interval.
struct WrittenValue {
  double value = 0;
  std::string interval;
};

/// Adds stiffness, mass and the source of both: lines of [rod], or a [[material]].
/// @throws compare::InputError if the scene has one of EI and mass per length, and not the other
void add_rod_lines(std::string& out, const compare::Scene& scene, const WrittenValue& stiffness,
                   const WrittenValue& heaviness, const std::string& source);

}  // namespace dlo::cli
