#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "batch/regression.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "motion/moving_scene.hpp"

namespace dlo::cli {

/// For an option whose value is a share of the rod's length: takes "0.1%" and 0.001, above 0 and
/// below 1.
[[nodiscard]] CLI::Validator share_of_length();

/// For an option that takes "1%" and 0.01 alike, from 0 to `high`.
[[nodiscard]] CLI::Validator share_up_to(double high);

/// --relative and --absolute: by how much an error may grow.
void add_growth_options(CLI::App& command, compare::RegressionTolerance& tolerance);

/// --damping, --drag and --quadratic-drag of a rod with inertia.
/// @param needed  the option that they go with
void add_damping_options(CLI::App& command, compare::RodDamping& damping, CLI::Option* needed);

/// What a shape is held against.
struct ToleranceWords {
  std::string allowed;             ///< "1%" or 0.01 of the rod's length, or a length with a unit
  std::string measure = "rms";     ///< or "max"
  std::optional<double> min_seen;  ///< share that a part of the rod has at least; none: a whole one
};

/// @param name  for messages. @throws compare::InputError
[[nodiscard]] compare::ShapeTolerance shape_tolerance(const std::string& name,
                                                      const ToleranceWords& words, double length);

}  // namespace dlo::cli
