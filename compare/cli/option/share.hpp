#pragma once

#include <optional>
#include <string>

#include "batch/regression.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "motion/moving_scene.hpp"
#include "option/command_line.hpp"

namespace dlo::cli {

/// Reads a share such as "1%" or 0.01. @throws compare::InputError if the text is no number
[[nodiscard]] double parse_fraction(const std::string& text);

/// Returns the fraction of a tolerance such as "5% of deflection"; empty if the text is not a
/// fraction of the deflection.
/// @param name  name of the option in messages. @throws compare::InputError if the fraction is not
/// between 0 and 1
[[nodiscard]] std::optional<double> deflection_share(const std::string& name,
                                                     const std::string& text);

/// Reads the absolute tolerance of an error's growth: "1%" or 0.01 of the rod's length, or "5% of
/// deflection". @param name  name of the option in messages. @throws compare::InputError
void set_growth(const std::string& name, const std::string& text,
                compare::RegressionTolerance& tolerance);

/// Options --damping, --drag and --quadratic-drag of a rod with inertia.
struct DampingOptions {
  std::optional<double> material, air, quadratic;  ///< see compare::RodDamping; empty if not given

  void add_to(Command& command);
  /// Returns each damping constant: the given value, else that of the calibrated rod, else 0.
  [[nodiscard]] compare::RodDamping of(const compare::CalibratedRod& rod) const;
};

/// Tolerance of a shape, as text.
struct ToleranceOptions {
  /// "1%" or 0.01 of the rod's length, "5% of deflection", or a length with a unit; empty: the
  /// default.
  std::optional<std::string> allowed;
  std::string measure = "rms";  ///< or "max"
  /// Smallest allowed fraction of the rod that is observed, for points on a part of the rod, which
  /// alone is judged; empty: the whole rod is judged.
  std::optional<double> min_observed_share;
};

/// Reads a tolerance. compare::check() computes one that is relative to the deflection.
/// @param name  name of the option in messages. @throws compare::InputError
[[nodiscard]] compare::ShapeTolerance shape_tolerance(const std::string& name,
                                                      const ToleranceOptions& words, double length);

}  // namespace dlo::cli
