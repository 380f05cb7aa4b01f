#pragma once

#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "dlo/compare/progress.hpp"

namespace dlo::compare {

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
  /// Measured cases, to be written as a new baseline of these scenes.
  std::vector<BaselineCase> cases;

  /// Whether every case was solved.
  [[nodiscard]] bool solved() const;
  /// Whether no case has failed().
  [[nodiscard]] bool passes() const;
};

/// Measures scenes and compares them with the baseline. A solver that does not converge gives the
/// verdict not_solved, no exception.
/// @param progress  counts the cases
/// @throws InputError if a model does not accept a scene, and as judge_regression()
[[nodiscard]] Regression regress(const std::vector<Scene>& scenes,
                                 const std::vector<BaselineCase>& baseline,
                                 const RegressRequest& request, const Progress& progress = {});

}  // namespace dlo::compare
