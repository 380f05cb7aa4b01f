#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"

namespace dlo::cli {

/// Options that override a scene's [force_model] and control the solvers.
class SceneOptions {
 public:
  /// Adds those of its options that the command has.
  void add_to(Command& command);

  /// Loads a scene and applies the options. @throws compare::InputError
  [[nodiscard]] compare::Scene load(const std::string& path) const;
  /// Returns the rod of --calibrated; without that option, a rod that replaces nothing.
  /// @throws compare::InputError
  [[nodiscard]] compare::CalibratedRod calibrated() const;
  [[nodiscard]] const compare::SolveOptions& solve() const { return solve_; }
  [[nodiscard]] std::vector<compare::Material> materials() const;
  [[nodiscard]] bool gives_points() const { return points_ > 0; }

 private:
  void apply(compare::Scene& scene) const;

  const CLI::App* command_ = nullptr;
  std::string materials_, calibrated_, parameters_;
  int points_ = 0;
  // Members of ForceModelSettings, which are set after --parameters.
  std::optional<compare::BendingLaw> law_;
  std::optional<compare::Bookkeeping> bookkeeping_;
  std::optional<compare::Stepper> stepper_;
  std::optional<compare::BendingRule> bending_rule_;
  std::optional<double> design_curvature_, c_b_, c_c_, c_F_, c_h_, l_s_;
  std::optional<double> time_;
  compare::SolveOptions solve_;
};

/// Options --explain and --target-error.
struct PlanOptions {
  bool explain = false;
  compare::PlanOptions plan;

  void add_to(Command& command) {
    command.bind("--explain", explain, "--target-error", plan.target);
  }
};

/// Reports on standard error the assumptions that were made to read a scene from a simulator's
/// model.
void print_assumptions(const compare::Scene& scene);

/// Reports on standard error that the models neglect the friction of an obstacle in reach.
void warn_of_friction(const compare::Scene& scene);

/// Reports on standard error the properties of a scene that the models chain and force neglect:
/// twist between its grippers, natural curvature, friction.
void warn_of_neglected_by_polygon(const compare::Scene& scene);

/// Reports on standard error that a study neglects twist, for a scene whose twist the models chain
/// and force include.
void warn_of_no_twist(const compare::Scene& scene, const std::string& study);

}  // namespace dlo::cli
