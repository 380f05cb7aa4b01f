#pragma once

#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "dlo/compare/progress.hpp"

namespace dlo::compare {

/// What is measured of scenes, and how much of it may change.
struct RegressRequest {
  Model model = Model::force;            ///< force or chain
  std::vector<ForeignProgram> programs;  ///< whose shapes are measured too
  RegressionTolerance tolerance;
  SolveOptions solve;
};

/// Scenes against a baseline: what `dlo regress` says.
struct Regression {
  std::vector<RegressionResult> results;  ///< sorted by name
  std::vector<BaselineCase> cases;        ///< as measured, for a baseline of these scenes

  /// Whether every case was.
  [[nodiscard]] bool solved() const;
  /// Whether none has failed().
  [[nodiscard]] bool passes() const;
};

/// Measures scenes and judges them. A solver that does not converge is a result.
/// @param progress  of the cases
/// @throws InputError of a scene that a model cannot have, and as judge_regression()
[[nodiscard]] Regression regress(const std::vector<Scene>& scenes,
                                 const std::vector<BaselineCase>& baseline,
                                 const RegressRequest& request, const Progress& progress = {});

}  // namespace dlo::compare
