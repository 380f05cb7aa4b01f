#include "wire/wire_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "wire/identifiable.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_optimum.hpp"

namespace dlo::compare {
namespace {

/// Distance of the material's log E from the scene's above which both are tried as starts: the E
/// that fits best without the other numbers may differ from the one with them.
constexpr double distant_log_modulus = 0.7;

/// Start of a fit, combined from several trials. For each shape it has the rod, and the numbers
/// that belong to this shape alone, of the trial that is nearest to the shape's points.
struct NearestStart {
  std::vector<double> sum_of_squares;
  FittedRods::Rods rods;
  Eigen::VectorXd values;

  [[nodiscard]] double sum() const {
    return std::accumulate(sum_of_squares.begin(), sum_of_squares.end(), 0.0);
  }

  void keep_nearer(const WireProblem& problem, const FittedRods::State& state,
                   const Eigen::VectorXd& others) {
    if (sum_of_squares.empty()) {
      *this = {state.sum_of_squares, state.rods, others};
      return;
    }
    for (std::size_t i = 0; i < sum_of_squares.size(); ++i) {
      if (!(state.sum_of_squares[i] < sum_of_squares[i])) continue;
      sum_of_squares[i] = state.sum_of_squares[i];
      rods[i] = state.rods[i];
      for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
        const auto number = static_cast<Eigen::Index>(k);
        if (problem.belongs_to_shape(k, i)) values[number] = others[number];
      }
    }
  }
};

/// Whether the mean natural curvature is fitted about both axes of the section; the number about d2
/// is the first.
bool is_about_both_axes(const WireProblem& problem) {
  const auto second = static_cast<std::size_t>(problem.first_remaining_number()) + 1;
  return second < problem.numbers.size() && problem.numbers[second].term == 0 &&
         problem.numbers[second].described.unit == "1/m";
}

/// Returns the nearest start for each of several mean curvatures in the likely range: up to 8 rad
/// along the rod, to either side. The curvatures are visited from both ends, and each shape follows
/// its own equilibrium. If the roll of the clamp is unknown, several angles are tried. A curvature
/// about both axes has several directions.
std::vector<NearestStart> nearest_by_curvature(const WireProblem& problem,
                                               const Eigen::VectorXd& from, FittedRods& rods) {
  constexpr std::array mean_turns = {8.0, 5.0, 3.0, 1.5, 0.0, -1.5, -3.0, -5.0, -8.0};
  constexpr int angles = 6;
  const bool rotates_rod =
      std::ranges::any_of(problem.numbers, [](const WireNumber& one) { return one.rotates_rod; });
  const bool both_axes = is_about_both_axes(problem);
  // Negative turns represent the opposite axes.
  const int directions = both_axes ? angles / 2 : 1;
  std::vector<NearestStart> found(directions * mean_turns.size());
  for (int i = 0; i < directions * (rotates_rod ? angles : 1); ++i) {
    const int direction = i % directions;
    const int angle = i / directions;
    const auto add_best_start = [&](std::size_t k) {
      Eigen::VectorXd values = from;
      const double curvature = mean_turns[k] / problem.scenes.front().length;
      const double about = 2 * std::numbers::pi * direction / angles;
      values[problem.first_remaining_number()] = curvature * std::cos(about);
      if (both_axes) values[problem.first_remaining_number() + 1] = curvature * std::sin(about);
      for (std::size_t n = 0; n < problem.numbers.size(); ++n) {
        if (!problem.numbers[n].rotates_rod) continue;
        values[static_cast<Eigen::Index>(n)] = 2 * std::numbers::pi * angle / angles;
      }
      found[direction * mean_turns.size() + k].keep_nearer(problem, rods.state(values), values);
    };
    rods.clear_initial_rods();
    for (std::size_t k = 0; k < mean_turns.size(); ++k) add_best_start(k);
    rods.clear_initial_rods();
    for (std::size_t k = mean_turns.size(); k-- > 0;) add_best_start(k);
  }
  return found;
}

/// Values of all numbers, and the rods from which the iteration starts.
struct Start {
  Eigen::VectorXd values;
  FittedRods::Rods rods;
};

/// Returns the starts in the order of their sums of squares. An intrinsically curved rod may hang
/// on the other side of its clamp, and the E that fits best without natural curvature may be far
/// away. So mean curvatures are tried with that E and with the scene's, and each shape starts with
/// the trial that is nearest to its points.
std::vector<Start> starts_by_curvature(const WireProblem& problem, FittedRods& rods,
                                       Eigen::VectorXd from) {
  std::vector<NearestStart> found;
  std::vector<double> moduli = {from[0]};
  if (from[0] != 0) moduli.push_back(0);
  for (const double log_modulus : moduli) {
    from[0] = log_modulus;
    std::vector<NearestStart> some = nearest_by_curvature(problem, from, rods);
    // In reverse order, so that of two equal starts the later one is used.
    std::move(some.rbegin(), some.rend(), std::back_inserter(found));
  }
  std::ranges::stable_sort(found, {}, &NearestStart::sum);
  std::vector<Start> result;
  for (NearestStart& one : found) {
    if (std::isfinite(one.sum())) result.push_back({std::move(one.values), std::move(one.rods)});
  }
  return result;
}

/// Sets rods and values to the fit of least variance among those that coarse fits reach from the
/// starts.
void set_to_best_start(const WireProblem& problem, const std::vector<Start>& starts,
                       FittedRods& rods, Eigen::VectorXd& values) {
  double least = INFINITY;
  FittedRods::Rods nearest(problem.scenes.size());
  for (const Start& start : starts) {
    rods.set_initial_rods(start.rods);
    GaussNewton fit(rods, start.values, problem.coarse_iteration_options());
    if (!fit.descend() || !(fit.variance() < least)) continue;
    least = fit.variance();
    nearest = fit.rods();
    values = fit.values();
  }
  rods.set_initial_rods(std::move(nearest));
}

/// Chooses the start for E. If the rod is not held as the scene states, the E that fits best with
/// the scene's grips may be far away, so the fit also starts at the scene's E.
void choose_modulus_start(const WireProblem& problem, FittedRods& rods, Eigen::VectorXd& values) {
  const FittedRods::Rods none(problem.scenes.size());
  Eigen::VectorXd without_first = values;
  without_first[0] = 0;
  set_to_best_start(problem, {{values, none}, {without_first, none}}, rods, values);
}

/// Adds terms of natural curvature one by one, each fit starting at the result without the new
/// term, so that more terms never fit worse than fewer.
void fit_fewer_terms(const WireProblem& problem, FittedRods& rods, Eigen::VectorXd& values) {
  for (int terms = 1; terms < problem.options.natural_curvature_terms; ++terms) {
    FittedRods fewer = problem.rods(terms);
    fewer.set_initial_rods(rods.rods());
    GaussNewton fit(fewer, values, problem.coarse_iteration_options());
    if (!fit.descend()) return;
    values = fit.values();
    rods.set_initial_rods(fit.rods());
  }
}

/// Number of mean curvatures from which fits with all terms start in addition. A rod that leaves
/// its plane may lose its stability between one fit and the next: a fit with fewer terms of natural
/// curvature can end at that limit, which no step with more terms leaves. (On 100 wires of
/// WireFit's coverage test, one of four starts reached the best fit in all cases that had ended at
/// the limit.)
constexpr std::size_t most_starts = 4;

void choose_curvature_start(const WireProblem& problem, FittedRods& rods, Eigen::VectorXd& values) {
  std::vector<Start> starts = starts_by_curvature(problem, rods, values);
  if (starts.empty()) return;
  starts.resize(std::min(starts.size(), most_starts));
  values = starts.front().values;
  rods.set_initial_rods(starts.front().rods);
  fit_fewer_terms(problem, rods, values);
  for (std::size_t i = 0; i < problem.shapes.size(); ++i) {
    if (problem.measured.is_flat(i)) continue;
    starts.insert(starts.begin(), {values, rods.rods()});
    return set_to_best_start(problem, starts, rods, values);
  }
}

/// Returns values of a wire's numbers from which the iteration converges to the fit.
/// @param material     material that fits best without the other numbers
/// @param[in,out] rods  rods with all numbers; set to the equilibria nearest to the shapes there
Eigen::VectorXd wire_start(const WireProblem& problem, const MaterialPoint& material,
                           FittedRods& rods) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.numbers.size()));
  if (material.log_modulus > problem.lowest()) values[0] = material.log_modulus;
  if (problem.density) values[1] = material.log_density;
  if (problem.options.natural_curvature_terms > 0) {
    choose_curvature_start(problem, rods, values);
  } else if (std::abs(values[0]) > distant_log_modulus) {
    choose_modulus_start(problem, rods, values);
  }
  return values;
}

/// Predicts the scene of a shape by the fit to the others, which starts at the fit to all and uses
/// its weights. Numbers that belong to the shape alone are set to zero.
PredictedScene predicted(const WireProblem& problem, const WireOptimum& all, std::size_t excluded) {
  const std::vector<Scene> scenes = without_one(problem.scenes, excluded);
  const std::vector<MeasuredShape> shapes = without_one(problem.shapes, excluded);
  MeasuredShapes measured(scenes, shapes, measured_options(problem.options), Timer());
  WireProblem others(scenes, shapes, measured, problem.options, problem.density);
  std::vector<Eigen::Index> common;
  for (std::size_t k = 0; k < problem.numbers.size(); ++k) {
    if (problem.belongs_to_shape(k, excluded)) continue;
    others.numbers[common.size()].difference_step = problem.numbers[k].difference_step;
    common.push_back(static_cast<Eigen::Index>(k));
  }
  FittedRods rods = others.rods(problem.options.natural_curvature_terms);
  rods.set_initial_rods(without_one(all.rods(), excluded));
  GaussNewton fit(rods, all.values()(common), others.steps());
  fit.set_data_variance(all.fit().weight());
  others.descend(fit);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(all.values().size());
  values(common) = fit.values();
  return {problem.scene_at(excluded, values), all.rods()[excluded]};
}

/// Returns the index of the term of natural curvature that the shapes determine least, among the
/// nonzero terms that they determine less than the prior does; std::nullopt if there is no such
/// term.
std::optional<std::size_t> undetermined_term(const WireProblem& problem, const MaterialFit& fit) {
  const auto first = static_cast<std::size_t>(problem.first_remaining_number());
  std::optional<std::size_t> result;
  double largest = 0;
  for (std::size_t k = 0; k < fit.others.size(); ++k) {
    const FittedNumber& number = fit.others[k];
    const bool is_term = number.unit == "1/m" && problem.numbers[first + k].difference_step > 0;
    if (!is_term || number.is_determined_by_shapes() || number.value == 0) continue;
    const double share = number.deviation / number.prior_deviation;
    if (!(share > largest)) continue;
    largest = share;
    result = first + k;
  }
  return result;
}

/// Returns the fit in which terms of natural curvature that the shapes do not determine are set to
/// zero, their most likely prior value. Otherwise the other numbers would compensate for them,
/// which makes predictions of other shapes worse.
MaterialFit determined_fit(const WireProblem& problem, WireOptimum& optimum) {
  const MaterialFitOptions& options = problem.options;
  MaterialFit fit = wire_result(problem, optimum);
  if (const std::optional<std::size_t> term = undetermined_term(problem, fit)) {
    WireProblem fewer = problem;
    fewer.numbers[*term].difference_step = 0;
    FittedRods rods = fewer.rods(options.natural_curvature_terms);
    rods.set_initial_rods(optimum.rods());
    Eigen::VectorXd values = optimum.values();
    values[static_cast<Eigen::Index>(*term)] = 0;
    WireOptimum other(fewer, rods, values);
    MaterialFit result = determined_fit(fewer, other);
    // The shapes do not determine the term, which does not mean that it is zero.
    const bool is_identified =
        include_interval(result.youngs_modulus, fit.youngs_modulus, options.largest_interval_ratio);
    if (!is_identified && result.not_identified.empty()) {
      result.not_identified = fit.not_identified;
    }
    return result;
  }
  if (options.predict) {
    fit.prediction =
        leave_one_out(problem.scenes, problem.shapes, options, fit,
                      [&](std::size_t excluded) { return predicted(problem, optimum, excluded); });
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
