#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material_fit.hpp"

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

}  // namespace dlo::cli
