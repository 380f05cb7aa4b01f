#include "explain/cause_fit.hpp"

#include <utility>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "least_squares/gauss_newton.hpp"

namespace dlo::compare {
namespace {

/// Smallest relative decrease of the mean square that a step must promise.
constexpr double least_gain = 0.1;

/// Sets the rods to an equilibrium of the scene at the start of the cause: if the start is zero,
/// the one to which the compared equilibrium leads, else the one that a search finds. If the cause
/// changes how the rod is held, the one that a search finds is used if it is nearer to the shape.
/// Returns false if there is no equilibrium.
bool goes_to_state(const SceneCause& cause, const energy_model::Equilibrium& rod,
                   FittedRods& rods) {
  if (cause.start.isZero()) rods.go_on_from({rod});
  FittedRods::State state = rods.state(cause.start);
  if (cause.other_state) {
    rods.search_next();
    FittedRods::State lowest = rods.state(cause.start);
    if (lowest.squares[0] < state.squares[0]) state = std::move(lowest);
  }
  rods.go_on_from(state.rods);
  return state.rods[0].has_value();
}

/// Returns the numbers whose rod is nearest to the shape, and sets `rods` to that rod.
Eigen::VectorXd best_numbers(const SceneCause& cause, double noise, FittedRods& rods) {
  if (cause.stride.isZero()) return cause.start;
  GaussNewton fit(rods, cause.start, {.noise = noise, .last_step = 0.05, .least_gain = least_gain});
  const FittedRods::Rods start = rods.rods();
  try {
    (void)fit.descend();
  } catch (const ConvergenceError&) {
    // The time limit ends the fit; the numbers so far are used.
  }
  rods.go_on_from(fit.rods().empty() ? start : fit.rods());
  return fit.values();
}

}  // namespace

std::optional<FittedCause> fit_cause(const SceneCause& cause, const MeasuredShape& shape,
                                     const energy_model::Equilibrium& rod,
                                     const ShapeCheckOptions& options,
                                     const CauseFitLimits& limits) {
  const std::vector<Scene> scene = {cause.changed(cause.start)};
  MeasuredShapes measured(scene, {shape},
                          {.pose = options.pose,
                           .arc_lengths = options.arc_lengths,
                           .weights = PointWeights::by_length,
                           .solve = options.solve,
                           .flat = FlatShapes::measured},
                          limits.timer);
  std::vector<Unknown> unknowns;
  for (const double stride : cause.stride) {
    unknowns.push_back({.stride = stride, .longest_step = cause.longest_step});
  }
  FittedRods rods(
      measured, [&](std::size_t, const Eigen::VectorXd& p) { return cause.changed(p); }, unknowns);
  if (!goes_to_state(cause, rod, rods)) return std::nullopt;
  const Eigen::VectorXd numbers = best_numbers(cause, limits.noise, rods);
  return FittedCause{numbers, *rods.rods()[0]};
}

}  // namespace dlo::compare
