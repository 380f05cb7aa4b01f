#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batch/baseline.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/compare/solution.hpp"
#include "foreign/foreign_program.hpp"

namespace dlo::compare {

/// The case that a scene is, before it is solved: without errors.
[[nodiscard]] BaselineCase case_of(const Scene& scene, Model model);

/// Solves a scene with `model` (chain or force) and with the energy model.
/// @throws InputError, ConvergenceError
[[nodiscard]] BaselineCase measure_case(const Scene& scene, Model model,
                                        const SolveOptions& options = {});

/// What became of a case's errors.
enum class RegressionVerdict {
  same,
  better,
  worse,
  changed,          ///< of the same name, but its scene or settings are not the baseline's
  not_in_baseline,  ///< measured, but the baseline does not know it
  not_measured,     ///< in the baseline, but not measured
  not_solved,       ///< a solver did not converge
};

/// In words, for tables.
template <>
struct Choices<RegressionVerdict> {
  /// In the enumeration's order.
  static constexpr Choice<RegressionVerdict> all[] = {
      {RegressionVerdict::same, "same", ""},
      {RegressionVerdict::better, "better", ""},
      {RegressionVerdict::worse, "worse", ""},
      {RegressionVerdict::changed, "changed", ""},
      {RegressionVerdict::not_in_baseline, "not in the baseline", ""},
      {RegressionVerdict::not_measured, "not measured", ""},
      {RegressionVerdict::not_solved, "not solved", ""}};
};

/// Everything but same and better.
[[nodiscard]] bool failed(RegressionVerdict verdict);

/// A share e of the rod's length has changed if it is off by more than absolute + relative * e.
struct RegressionTolerance {
  double relative = 0.01;      ///< share of the error
  double absolute = 1e-6;      ///< share of the rod's length
  bool of_deflection = false;  ///< `absolute` is a share of the deflection (TrivialShape) instead
};

/// One case against its baseline.
struct RegressionResult {
  std::string name;  ///< of the case, BaselineCase::name(); of a changed one that of this run
  RegressionVerdict verdict = RegressionVerdict::not_solved;  ///< on all its errors
  std::optional<ShapeErrors> expected;  ///< of the baseline, if it knows the case
  std::optional<ShapeErrors> measured;  ///< of this run, if it was solved
  std::string message;                  ///< one line, in % of the rod's length
};

/// A scene and model that were asked for: its errors, or why there are none.
struct MeasuredCase {
  BaselineCase entry;   ///< without errors if it was not solved
  std::string problem;  ///< of the solver; empty if there is none
  /// TrivialShape::deflection_m over the length, for a tolerance of it; else 1.
  double deflection_share = 1;
};

/// Runs somebody else's program on a scene, with as many points as that says, and measures its
/// shape against the energy model's. @throws ConvergenceError, InputError of the energy model
[[nodiscard]] MeasuredCase measure_program(const Scene& scene, const ForeignProgram& program,
                                           const SolveOptions& options = {});

/// Every case of either side, sorted by name. A case is worse if any of its errors is, better if
/// none is worse and any is better; an error that only one side has is worse. A case is changed,
/// whatever its errors, if its scene's fingerprint is another, or if it is the only one of its
/// scene and model that the baseline lacks, and the baseline has one of them that was not measured.
/// @throws InputError if two measured cases have the same name, std::invalid_argument if a
/// tolerance is negative or not finite
[[nodiscard]] std::vector<RegressionResult> judge_regression(
    const std::vector<BaselineCase>& baseline, const std::vector<MeasuredCase>& measured,
    const RegressionTolerance& tolerance = {});

/// JUnit XML: a `failure` for what is worse or on one side only, an `error` for what was not
/// solved.
[[nodiscard]] std::string junit_xml(const std::vector<RegressionResult>& results);

}  // namespace dlo::compare
