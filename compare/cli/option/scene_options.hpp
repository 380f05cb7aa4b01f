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

/// Whether a command steps the force model, and so has the options that limit its steps.
enum class Steps { made, none };

/// Options that override a scene's [force_model] and steer the solvers.
class SceneOptions {
 public:
  void add_to(CLI::App& command, Steps steps = Steps::made);
  /// The same for a scene that is looked at while it moves: no --time.
  void add_moving_to(CLI::App& command);
  /// Only those that override [force_model], --materials and --calibrated.
  void add_settings_to(CLI::App& command);
  /// Only those that steer the solvers, --materials and --calibrated.
  void add_solvers_to(CLI::App& command, Steps steps = Steps::made);

  /// Loads a scene and applies the options. @throws compare::InputError
  [[nodiscard]] compare::Scene load(const std::string& path) const;
  /// Returns the rod of --calibrated; without that option it replaces nothing.
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
  /// What the options given change, after --parameters.
  std::vector<std::function<void(compare::ForceModelSettings&)>> changes_;
  std::optional<double> time_;
  compare::SolveOptions solve_;
};

/// --explain and --target-error.
class PlanOptions {
 public:
  void add_to(CLI::App& command);

  [[nodiscard]] bool explain() const { return explain_; }
  [[nodiscard]] const compare::PlanOptions& plan() const { return plan_; }

 private:
  bool explain_ = false;
  compare::PlanOptions plan_;
};

/// Says on standard error what a scene that was made from a simulator's model takes for what.
void say_assumptions(const compare::Scene& scene);

/// Says on standard error that no model has the friction of an obstacle in reach.
void warn_of_friction(const compare::Scene& scene);

/// Says on standard error what models chain and force neglect that a scene has: twist that its
/// grippers hold, natural curvature, friction.
void warn_of_polygons(const compare::Scene& scene);

/// The same of a study that has no twist where models chain and force have it.
void warn_of_no_twist(const compare::Scene& scene, const std::string& study);

/// @param formats  those that the command writes
void add_output_options(CLI::App& command, OutputOptions& options,
                        const std::vector<std::string>& formats = compare::names<Format>());

/// Makes the extension of the output file the format of the command unless --format is given.
void take_format_of_file(CLI::App& command, OutputOptions& options,
                         const std::vector<std::string>& formats);

}  // namespace dlo::cli
