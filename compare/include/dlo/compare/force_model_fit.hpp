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
  fitted,          ///< law paper: the one c_b that is nearest to all scenes (RMS)
  fitted_alone,    ///< law paper: for each scene the c_b that is nearest to it: no c_b does better
};

/// In words, for tables.
template <>
struct Choices<StiffnessRule> {
  /// In the enumeration's order.
  static constexpr Choice<StiffnessRule> all[] = {
      {StiffnessRule::physical, "physical", ""},
      {StiffnessRule::formula_21, "formula_21", ""},
      {StiffnessRule::moment_matched, "moment_matched", ""},
      {StiffnessRule::fitted, "fitted", ""},
      {StiffnessRule::fitted_alone, "fitted_alone", ""}};
};

/// What parameters are wanted.
struct ForceModelFitOptions {
  /// N; without it the target decides (law hooke), or the scene (law paper, whose error does not
  /// fall with N).
  std::optional<int> points;
  double target = 1e-3;  ///< RMS deviation over the rod's length, > 0
  SolveOptions solve;    ///< limits of the solvers
  Progress progress;     ///< over fits and runs to rest; may be empty
};

/// One rule on all scenes; values in their order, hold-out scenes last.
struct RuleDeviations {
  StiffnessRule rule = StiffnessRule::physical;  ///< how c_b was chosen
  std::vector<double> c_b;                       ///< [N]; law hooke: none
  std::vector<double> rms_over_length;           ///< of the chain; NaN where the rule gives no c_b
};

/// Parameters of the force model for one material, and what they give.
struct ForceModelFit {
  /// To be used: N, law, bookkeeping, c_b (law paper), c_c, and stepper dynamic with its c_F, c_h
  /// and l_s; or the first scene's verlet or implicit, which have none of these.
  ForceModelSettings settings;
  bool c_b_was_given = false;  ///< `fitted` is then the given one
  bool c_c_was_given = false;  ///< by the scene or an option
  /// The target asked for a stiffer rod than the material makes, or nothing pulls at it: c_c is AE,
  /// and the rod's own stretch, which the energy model neglects, is part of the deviation.
  bool c_c_is_physical = false;
  bool points_were_given = false;     ///< N was not chosen
  double target = 0;                  ///< RMS deviation over the length that was asked for [-]
  std::vector<std::string> scenes;    ///< names, hold-out scenes last
  std::vector<double> gammas;         ///< w l^3 / (EI) of each scene [-]
  std::size_t holdouts = 0;           ///< how many of them were held out
  std::vector<RuleDeviations> rules;  ///< every rule that was tried
  /// The force model itself, stepped to rest with `settings`.
  std::vector<double> stepped_rms_over_length;
  /// RMS distance of that shape from the rigid segments' at the same N, over the length: what the
  /// stretch makes. It hardly depends on N.
  std::vector<double> stretch_rms_over_length;
  std::vector<long> steps;       ///< that it took, of each scene
  double order = 0;              ///< of convergence in the segment length, as measured; 0: not used
  double segment_length = 0;     ///< L of the first scene [m]
  double bending_stiffness = 0;  ///< EI of the first scene [N m^2]

  /// Largest stepped deviation of the scenes (of the hold-out scenes).
  [[nodiscard]] double worst() const;
  /// The same of the hold-out scenes; 0 without any.
  [[nodiscard]] double worst_holdout() const;
  /// No scene's stepped deviation is above the target.
  [[nodiscard]] bool reached() const;
  /// Sentences on what keeps the target from being reached; empty if it is.
  [[nodiscard]] std::vector<std::string> why_missed() const;
};

/// Derives the force model's parameters from physics.
///
/// N: the deviation of the chain at rest, worst of the scenes, is measured at N = 16 and 32; from
/// this order of convergence follows the N that brings it below 0.9 of the target, which is then
/// tried and raised until it does. c_b of the paper's law: Formula 21, moment-matched, and by
/// GSL's Brent minimiser over log c_b, on the chain, whose rest shape is the force model's.
/// c_c: as low as a stretch of a tenth of the target allows, for steps grow with its root; no more
/// than AE. Steppers verlet and implicit are kept, for any other c_F and c_h: Polyak's heavy ball
/// for the stiffest and slowest modes at the start and at rest in any of the scenes; l_s: a quarter
/// of a segment. Given numbers in the first scene's settings (c_b, c_c) are kept. The stepped force
/// model then has the last word.
/// @param holdouts  scenes that only judge
/// @throws InputError if scenes differ in law or bookkeeping; ConvergenceError
[[nodiscard]] ForceModelFit fit_force_model(const std::vector<Scene>& scenes,
                                            const std::vector<Scene>& holdouts,
                                            const ForceModelFitOptions& options = {});

}  // namespace dlo::compare
