#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "batch/regression.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::cli {

/// For an option whose value is a share of the rod's length: takes "0.1%" and 0.001, above 0 and
/// below 1.
[[nodiscard]] CLI::Validator share_of_length();

/// For an option that takes "1%" and 0.01 alike, from 0 to `high`.
[[nodiscard]] CLI::Validator share_up_to(double high);

/// Returns the share of a tolerance such as "5% of deflection"; empty if it is not one of
/// deflection.
/// @param name  for messages. @throws compare::InputError if the share is not between 0 and 1
[[nodiscard]] std::optional<double> deflection_share(const std::string& name,
                                                     const std::string& text);

/// Reads how much an error may grow besides its own share: "1%" or 0.01 of the rod's length, or
/// "5% of deflection". @param name  for messages. @throws compare::InputError
void set_growth(const std::string& name, const std::string& text,
                compare::RegressionTolerance& tolerance);

/// --relative and --absolute: by how much an error may grow.
void add_growth_options(CLI::App& command, compare::RegressionTolerance& tolerance);

/// --damping, --drag and --quadratic-drag of a rod with inertia, where they are given.
struct DampingOptions {
  std::optional<double> material, air, quadratic;  ///< as RodDamping's

  /// @param needed  the option that they require
  void add_to(CLI::App& command, CLI::Option* needed);
  /// Returns the given values, in the place of others those of a calibrated rod, else 0.
  [[nodiscard]] compare::RodDamping of(const compare::CalibratedRod& rod) const;
};

/// What a shape is held against.
struct ToleranceWords {
  /// "1%" or 0.01 of the rod's length, "5% of deflection", or a length with a unit; none: the
  /// default
  std::optional<std::string> allowed;
  std::string measure = "rms";     ///< or "max"
  std::optional<double> min_seen;  ///< share that a part of the rod has at least; none: a whole one
};

/// Reads a tolerance; one of deflection is left for compare::check() to compute.
/// @param name  for messages. @throws compare::InputError
[[nodiscard]] compare::ShapeTolerance shape_tolerance(const std::string& name,
                                                      const ToleranceWords& words, double length);

}  // namespace dlo::cli
