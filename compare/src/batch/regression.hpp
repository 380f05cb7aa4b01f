#pragma once

#include <optional>
#include <string>
#include <vector>

#include "batch/baseline.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/compare/progress.hpp"
#include "dlo/compare/solution.hpp"
#include "foreign/foreign_program.hpp"

namespace dlo::compare {

/// One test case of a JUnit file.
struct JunitCase {
  std::string group;    ///< classname attribute
  std::string name;     ///< unique in its group
  std::string outcome;  ///< "failure", "error" or "skipped"; empty if the test case passes
  std::string type;     ///< type of the failure or error, one or a few words
  std::string message;  ///< one line; may be empty
  double seconds = 0;   ///< wall time [s]
};

struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

/// Returns JUnit XML with the counts of each suite and the total counts.
[[nodiscard]] std::string junit_xml(const std::vector<JunitSuite>& suites);

/// Returns the case of a scene and model, before it is solved: without errors.
[[nodiscard]] BaselineCase case_of(const Scene& scene, Model model);

/// Solves a scene with `model` (chain or force) and with the energy model, and returns the distance
/// between both shapes.
/// @throws InputError, ConvergenceError
[[nodiscard]] BaselineCase measure_case(const Scene& scene, Model model,
                                        const SolveOptions& options = {});

/// Comparison of a case's errors with the baseline.
enum class RegressionVerdict {
  same,
  better,
  worse,
  changed,  ///< its scene differs from the baseline's, or it replaces a case with other settings
  not_in_baseline,  ///< measured, but not contained in the baseline
  not_measured,     ///< in the baseline, but not measured
  not_solved,       ///< a solver did not converge, or a program gave no valid shape
};

/// Names of the verdicts in tables.
template <>
struct Choices<RegressionVerdict> {
  /// All verdicts, in the order of the enumeration.
  static constexpr Choice<RegressionVerdict> all[] = {
      {RegressionVerdict::same, "same", ""},
      {RegressionVerdict::better, "better", ""},
      {RegressionVerdict::worse, "worse", ""},
      {RegressionVerdict::changed, "changed", ""},
      {RegressionVerdict::not_in_baseline, "not in the baseline", ""},
      {RegressionVerdict::not_measured, "not measured", ""},
      {RegressionVerdict::not_solved, "not solved", ""}};
};

/// Whether a verdict is a failure: all but same and better are.
[[nodiscard]] bool failed(RegressionVerdict verdict);

/// Tolerance of a regression. An error has changed if it differs from the baseline's error e by
/// more than absolute + relative * e; both errors are divided by the rod's length.
struct RegressionTolerance {
  double relative = 0.01;  ///< fraction of the error, >= 0
  double absolute = 1e-6;  ///< fraction of the rod's length, >= 0
  /// Whether `absolute` is a fraction of the deflection (TrivialShape) instead.
  bool of_deflection = false;
};

struct RegressionResult {
  std::string name;  ///< BaselineCase::name() of the case; for a changed case, its name in this run
  /// Verdict over all errors of the case.
  RegressionVerdict verdict = RegressionVerdict::not_solved;
  std::optional<ShapeErrors> expected;  ///< baseline errors, if the baseline contains the case
  std::optional<ShapeErrors> measured;  ///< errors of this run, if the case was solved
  std::string message;                  ///< one line, errors in % of the rod's length
};

/// Requested scene and model: its errors, or the reason why there are none.
struct MeasuredCase {
  BaselineCase entry;   ///< its errors are 0 or empty if the case was not solved
  std::string problem;  ///< why the case was not solved; empty if it was
  std::string note;     ///< how the shape was interpreted; empty: as it is
  /// TrivialShape::deflection_m divided by the length if the tolerance is a fraction of it, else 1.
  double deflection_share = 1;
};

/// Compares the cases of the baseline and of this run, sorted by name. A case is worse if any of
/// its errors is worse, and better if none is worse and any is better. An error that only one side
/// has is worse. A solved case is changed, whatever its errors, in two cases: its scene's
/// fingerprint differs, or it is the only case of its scene and solver() that the baseline lacks,
/// and the baseline has exactly one case of them that was not measured.
/// @throws InputError if two measured cases have the same name, std::invalid_argument if a
/// tolerance is negative or not finite
[[nodiscard]] std::vector<RegressionResult> judge_regression(
    const std::vector<BaselineCase>& baseline, const std::vector<MeasuredCase>& measured,
    const RegressionTolerance& tolerance = {});

/// Returns JUnit XML: an `error` for each case that was not solved, a `failure` for each other case
/// that failed().
[[nodiscard]] std::string junit_xml(const std::vector<RegressionResult>& results);

/// Models and programs to measure, and the tolerance of their errors.
struct RegressRequest {
  Model model = Model::force;            ///< force or chain
  std::vector<ForeignProgram> programs;  ///< foreign programs whose shapes are measured too
  RegressionTolerance tolerance;
  SolveOptions solve;
};

/// Comparison of scenes with a baseline, as `dlo regress` prints it.
struct Regression {
  std::vector<RegressionResult> results;  ///< sorted by name
  /// Measured cases, to be written as a new baseline if solved(); the errors of cases that were not
  /// solved are 0 or empty.
  std::vector<BaselineCase> cases;

  /// Whether every case was solved.
  [[nodiscard]] bool solved() const;
  /// Whether no case has failed().
  [[nodiscard]] bool passes() const;
};

/// Measures scenes and compares them with the baseline. A solver that does not converge gives the
/// verdict not_solved, no exception.
/// @param progress  counts the cases
/// @throws InputError if a model does not accept a scene, and as judge_regression() and, for a
/// tolerance of deflection, required_deflection(); OutputError as run_foreign()
[[nodiscard]] Regression regress(const std::vector<Scene>& scenes,
                                 const std::vector<BaselineCase>& baseline,
                                 const RegressRequest& request, const Progress& progress = {});

}  // namespace dlo::compare
