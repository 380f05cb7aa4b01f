#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "option/output.hpp"

namespace dlo::cli {

/// Whether a command makes steps of the force model, and so has the options that limit them.
enum class Steps { made, none };

/// Options that override a scene's [force_model] and control the solvers.
class SceneOptions {
 public:
  void add_to(CLI::App& command, Steps steps = Steps::made);
  /// Adds the options for a scene that is examined while it moves: without --time.
  void add_moving_to(CLI::App& command);
  /// Adds only --time, --materials, --calibrated and the options that override [force_model].
  void add_settings_to(CLI::App& command);
  /// Adds only --materials, --calibrated and the options that control the solvers.
  void add_solvers_to(CLI::App& command, Steps steps = Steps::made);

  /// Loads a scene and applies the options. @throws compare::InputError
  [[nodiscard]] compare::Scene load(const std::string& path) const;
  /// Returns the rod of --calibrated; without that option, a rod that replaces nothing.
  /// @throws compare::InputError
  [[nodiscard]] compare::CalibratedRod calibrated() const;
  [[nodiscard]] const compare::SolveOptions& solve() const { return solve_; }
  [[nodiscard]] std::vector<compare::Material> materials() const;

 private:
  void add_time_to(CLI::App& command);
  void add_force_model_to(CLI::App& command);
  void add_materials_to(CLI::App& command);
  void apply(compare::Scene& scene) const;

  const CLI::App* command_ = nullptr;
  std::string materials_, calibrated_, parameters_;
  int points_ = 0;
  /// Changes by the given options, applied after --parameters.
  std::vector<std::function<void(compare::ForceModelSettings&)>> changes_;
  std::optional<double> time_;
  compare::SolveOptions solve_;
};

/// Options --explain and --target-error.
class PlanOptions {
 public:
  void add_to(CLI::App& command);

  [[nodiscard]] bool explain() const { return explain_; }
  [[nodiscard]] const compare::PlanOptions& plan() const { return plan_; }

 private:
  bool explain_ = false;
  compare::PlanOptions plan_;
};

/// Reports on standard error the assumptions that were made to read a scene from a simulator's
/// model.
void say_assumptions(const compare::Scene& scene);

/// Reports on standard error that the models neglect the friction of an obstacle in reach.
void warn_of_friction(const compare::Scene& scene);

/// Reports on standard error the properties of a scene that the models chain and force neglect:
/// twist between its grippers, natural curvature, friction.
void warn_of_polygons(const compare::Scene& scene);

/// Reports on standard error that a study neglects twist, for a scene whose twist the models chain
/// and force include.
void warn_of_no_twist(const compare::Scene& scene, const std::string& study);

/// Adds --format and -o. @param formats  formats that the command writes
void add_output_options(CLI::App& command, OutputOptions& options,
                        const std::vector<std::string>& formats = compare::names<Format>());

/// Sets the format to the extension of the output file unless --format is given.
void take_format_of_file(CLI::App& command, OutputOptions& options,
                         const std::vector<std::string>& formats);

}  // namespace dlo::cli
