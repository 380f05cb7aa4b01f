#include "wire/wire_fit.hpp"

#include <optional>

#include "base/timer.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_optimum.hpp"
#include "wire/wire_problem.hpp"
#include "wire/wire_result.hpp"
#include "wire/wire_start.hpp"

namespace dlo::compare {
namespace {

/// The scene of a shape as the fit to the others says, to which steps lead from the fit to all,
/// with its weights. What was the shape's own is as if nothing were known of it.
PredictedScene predicted(const WireProblem& problem, const WireOptimum& all, std::size_t left) {
  const std::vector<Scene> scenes = all_but(problem.scenes, left);
  const std::vector<MeasuredShape> shapes = all_but(problem.shapes, left);
  MeasuredShapes measured(scenes, shapes, measured_options(problem.options), Timer());
  const WireProblem others(scenes, shapes, measured, problem.options, problem.density);
  std::vector<Eigen::Index> common;
  for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
    if (!problem.is_own(k, left)) common.push_back(static_cast<Eigen::Index>(k));
  }
  FittedRods rods = others.rods(problem.options.natural_curvature_terms);
  rods.go_on_from(all_but(all.rods(), left));
  GaussNewton fit(rods, all.values()(common), others.steps());
  fit.weigh(all.fit().weight());
  others.descend(fit);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(all.values().size());
  values(common) = fit.values();
  return {problem.scene_at(left, values), all.rods()[left]};
}

}  // namespace

bool fits_a_wire(const MaterialFitOptions& options) {
  return options.torsional_stiffness || options.natural_curvature_terms > 0 ||
         options.direction_tolerance > 0 || options.position_tolerance > 0 ||
         options.roll_tolerance > 0 || options.camera_tilt > 0;
}

MaterialFit fit_wire(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                     MeasuredShapes& measured, const MaterialFitOptions& options,
                     const MaterialPoint& start, bool density) {
  const WireProblem problem(scenes, shapes, measured, options, density);
  FittedRods rods = problem.rods(options.natural_curvature_terms);
  WireOptimum optimum(problem, rods, wire_start(problem, start, rods));
  MaterialFit fit = wire_result(problem, optimum);
  if (options.predict) {
    fit.prediction = leave_one_out(scenes, shapes, options, fit, [&](std::size_t left) {
      return predicted(problem, optimum, left);
    });
  }
  return fit;
}

}  // namespace dlo::compare
