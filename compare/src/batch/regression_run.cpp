#include "batch/regression_run.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/shape_check.hpp"

namespace dlo::compare {
namespace {

/// Measures one case; a solver that does not converge is reported as its problem.
/// @param program  foreign program; null: the request's model
MeasuredCase measured_case(const Scene& scene, const RegressRequest& request,
                           const ForeignProgram* program) {
  try {
    MeasuredCase result = program != nullptr
                              ? measure_program(scene, *program, request.solve)
                              : MeasuredCase{measure_case(scene, request.model, request.solve), ""};
    if (request.tolerance.of_deflection) {
      const energy_model::Equilibrium loaded = solve_reference(scene, request.solve);
      result.deflection_share =
          required_deflection(scene, trivial_shape(scene, loaded, request.solve)) / scene.length;
    }
    return result;
  } catch (const ConvergenceError& error) {
    BaselineCase entry = case_of(scene, program != nullptr ? Model::force : request.model);
    if (program != nullptr) entry.program = program->name;
    return {std::move(entry), error.what()};
  }
}

}  // namespace

bool Regression::solved() const {
  return std::none_of(results.begin(), results.end(), [](const RegressionResult& result) {
    return result.verdict == RegressionVerdict::not_solved;
  });
}

bool Regression::passes() const {
  return std::none_of(results.begin(), results.end(),
                      [](const RegressionResult& result) { return failed(result.verdict); });
}

Regression regress(const std::vector<Scene>& scenes, const std::vector<BaselineCase>& baseline,
                   const RegressRequest& request, const Progress& progress) {
  std::vector<MeasuredCase> measured;
  const std::size_t all = scenes.size() * (1 + request.programs.size());
  const auto measure = [&](const Scene& scene, const ForeignProgram* program) {
    measured.push_back(measured_case(scene, request, program));
    if (!progress) return;
    progress(static_cast<std::int64_t>(measured.size()), static_cast<std::int64_t>(all));
  };
  for (const Scene& scene : scenes) {
    measure(scene, nullptr);
    for (const ForeignProgram& program : request.programs) measure(scene, &program);
  }
  Regression result{judge_regression(baseline, measured, request.tolerance), {}};
  for (MeasuredCase& one : measured) result.cases.push_back(std::move(one.entry));
  return result;
}

}  // namespace dlo::compare
