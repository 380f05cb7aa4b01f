#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// How the bending stiffness of the force model is chosen.
enum class StiffnessRule {
  physical,        ///< law hooke: EI, nothing to choose
  formula_21,      ///< law paper: each scene's own c_b by Formula 21
  moment_matched,  ///< law paper: each scene's own c_b, the physical moment at the design curvature
  fitted,  ///< law paper: the given c_b, else the one that fits all fitted scenes best (RMS)
  fitted_per_scene,  ///< law paper: the c_b of least deviation of each scene; no c_b does better
};

/// Names of the rules in tables.
template <>
struct Choices<StiffnessRule> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<StiffnessRule> all[] = {
      {StiffnessRule::physical, "physical", ""},
      {StiffnessRule::formula_21, "formula_21", ""},
      {StiffnessRule::moment_matched, "moment_matched", ""},
      {StiffnessRule::fitted, "fitted", ""},
      {StiffnessRule::fitted_per_scene, "fitted_alone", ""}};
};

/// Options of the fit.
struct ForceModelFitOptions {
  /// N; empty: chosen for the target (law hooke), or the scene's (law paper, whose error does not
  /// decrease with N).
  std::optional<int> points;
  double target = 1e-3;  ///< RMS deviation divided by the rod's length, > 0 and < 1
  SolveOptions solve;    ///< limits of the solvers
  Progress progress;     ///< called during fits and runs to rest; may be empty
};

/// Deviations of all scenes with one rule, in the order of the scenes, hold-out scenes last.
struct RuleDeviations {
  StiffnessRule rule = StiffnessRule::physical;  ///< how c_b was chosen
  std::vector<double> c_b;                       ///< [N]; empty for law hooke, NaN if there is none
  /// RMS deviation of the chain, divided by the length; NaN if the rule gives no c_b, infinite if
  /// the chain does not converge with it.
  std::vector<double> rms_over_length;
};

/// Parameters of the force model for one material, and the resulting deviations.
struct ForceModelFit {
  /// Recommended settings: N, law, bookkeeping, c_b (law paper), c_c, and stepper dynamic with its
  /// c_F, c_h and l_s; or the first scene's stepper verlet or implicit, which do not have these
  /// parameters.
  ForceModelSettings settings;
  bool c_b_was_given = false;  ///< whether `fitted` is a given c_b
  bool c_c_was_given = false;  ///< whether c_c was given by the scene or an option
  /// Whether c_c is AE, because the target requires a larger c_c than the material has, or because
  /// no force stretches the rod. The rod's own stretch, which the energy model neglects, is then
  /// part of the deviation.
  bool c_c_is_physical = false;
  bool points_were_given = false;     ///< whether N was given
  double target = 0;                  ///< requested RMS deviation, divided by the length [-]
  std::vector<std::string> scenes;    ///< names, hold-out scenes last
  std::vector<double> gammas;         ///< w l^3 / (EI) of each scene [-]
  std::size_t holdouts = 0;           ///< number of hold-out scenes
  std::vector<RuleDeviations> rules;  ///< all rules that were tried
  /// RMS deviation of the force model, stepped to rest with `settings`, divided by the length [-].
  std::vector<double> stepped_rms_over_length;
  /// RMS distance of the stepped shape from the chain's (solve_chain()) at the same N, divided by
  /// the length [-]: the effect of stretch where the chain's segments are rigid. It hardly depends
  /// on N.
  std::vector<double> stretch_rms_over_length;
  std::vector<long> steps;    ///< number of steps to rest, of each scene
  double order = 0;           ///< measured order of convergence in the segment length; 0: not used
  double segment_length = 0;  ///< L of the first scene [m]
  double bending_stiffness = 0;  ///< EI of the first scene [N m^2]

  /// Returns the largest stepped deviation of the fitted scenes [-].
  [[nodiscard]] double largest_deviation() const;
  /// Returns the largest stepped deviation of the hold-out scenes [-]; 0 without any.
  [[nodiscard]] double largest_holdout_deviation() const;
  /// Whether no scene's stepped deviation is above the target.
  [[nodiscard]] bool reaches_target() const;
  /// Returns sentences that explain why the target is not reached; empty if it is.
  [[nodiscard]] std::vector<std::string> shortfall_reasons() const;
};

/// Derives the force model's parameters from physics.
///
/// N, unless it is given or the law is the paper's: the largest deviation of the scenes' chains at
/// rest is measured at N = 16 and 32. The order of convergence predicts the N that brings it below
/// 0.9 of the target; N is then increased until it does, to at most 4000. c_b of the paper's law:
/// by Formula 21, moment-matched, and by GSL's Brent minimiser over log c_b. The deviation is that
/// of the chain, whose rest shape is the force model's. c_c: as small as a stretch of a tenth of
/// the target allows, since the number of steps grows with its square root; at most AE. Steppers
/// verlet and implicit are kept. For the others c_F and c_h are those of Polyak's heavy ball for
/// the stiffest and slowest modes at the start and at rest in any of the scenes, with a margin for
/// the stiffest, and l_s is a quarter of a segment. Given values in the first scene's settings
/// (c_b, c_c) are kept. Finally the force model is stepped to rest with these settings, and its
/// deviation is reported.
/// @param holdouts  scenes that are compared, but not fitted
/// @throws InputError if there is no scene to fit, scenes differ in law or bookkeeping, or the
/// target is out of range; ConvergenceError
[[nodiscard]] ForceModelFit fit_force_model(const std::vector<Scene>& scenes,
                                            const std::vector<Scene>& holdouts,
                                            const ForceModelFitOptions& options = {});

}  // namespace dlo::compare
