#include "wire/wire_fit.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "base/timer.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_optimum.hpp"
#include "wire/wire_problem.hpp"
#include "wire/wire_result.hpp"
#include "wire/wire_start.hpp"

namespace dlo::compare {
namespace {

/// Predicts the scene of a shape by the fit to the others, which starts at the fit to all and uses
/// its weights. Numbers that belong to the shape alone are set to zero.
PredictedScene predicted(const WireProblem& problem, const WireOptimum& all, std::size_t left) {
  const std::vector<Scene> scenes = all_but(problem.scenes, left);
  const std::vector<MeasuredShape> shapes = all_but(problem.shapes, left);
  MeasuredShapes measured(scenes, shapes, measured_options(problem.options), Timer());
  WireProblem others(scenes, shapes, measured, problem.options, problem.density);
  std::vector<Eigen::Index> common;
  for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
    if (problem.is_own(k, left)) continue;
    others.numbers[common.size()].stride = problem.numbers[k].stride;
    common.push_back(static_cast<Eigen::Index>(k));
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

/// Returns the index of the term of natural curvature that the shapes determine least, among the
/// nonzero terms that they determine less than the prior does; std::nullopt if there is no such
/// term.
std::optional<std::size_t> undetermined_term(const WireProblem& problem, const MaterialFit& fit) {
  const auto first = static_cast<std::size_t>(problem.first_of_others());
  std::optional<std::size_t> result;
  double largest = 0;
  for (std::size_t k = 0; k < fit.others.size(); ++k) {
    const FittedNumber& number = fit.others[k];
    const bool is_term = number.unit == "1/m" && problem.numbers[first + k].stride > 0;
    if (!is_term || number.is_seen() || number.value == 0) continue;
    const double share = number.deviation / number.known_before;
    if (!(share > largest)) continue;
    largest = share;
    result = first + k;
  }
  return result;
}

/// Extends the interval to that of the fit with the term: the shapes do not determine the term,
/// which does not mean that it is zero.
void widen(MaterialFit& fit, const MaterialFit& with_term, double identified_within) {
  FittedValue& E = fit.youngs_modulus;
  const FittedValue& other = with_term.youngs_modulus;
  E.low = E.low && other.low ? std::optional(std::min(*E.low, *other.low)) : std::nullopt;
  E.high = E.high && other.high ? std::optional(std::max(*E.high, *other.high)) : std::nullopt;
  if (E.low && E.high && *E.high <= identified_within * *E.low) return;
  E.value.reset();
  if (fit.not_identified.empty()) fit.not_identified = with_term.not_identified;
}

/// Returns the fit in which terms of natural curvature that the shapes do not determine are set to
/// zero, their most likely prior value. Otherwise the other numbers would compensate for them,
/// which makes predictions of other shapes worse.
MaterialFit determined_fit(const WireProblem& problem, WireOptimum& optimum) {
  const MaterialFitOptions& options = problem.options;
  MaterialFit fit = wire_result(problem, optimum);
  if (const std::optional<std::size_t> term = undetermined_term(problem, fit)) {
    WireProblem fewer = problem;
    fewer.numbers[*term].stride = 0;
    FittedRods rods = fewer.rods(options.natural_curvature_terms);
    rods.go_on_from(optimum.rods());
    Eigen::VectorXd values = optimum.values();
    values[static_cast<Eigen::Index>(*term)] = 0;
    WireOptimum other(fewer, rods, values);
    MaterialFit result = determined_fit(fewer, other);
    widen(result, fit, options.identified_within);
    return result;
  }
  if (options.predict) {
    fit.prediction =
        leave_one_out(problem.scenes, problem.shapes, options, fit,
                      [&](std::size_t left) { return predicted(problem, optimum, left); });
  }
  return fit;
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
  return determined_fit(problem, optimum);
}

}  // namespace dlo::compare
