#include "dlo/compare/effective_modulus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/interrupt.hpp"
#include "polygon/scalar_search.hpp"

namespace dlo::compare {
namespace {

/// Steps per decade of the scan along ln(E*/E), and number of steps without improvement, half a
/// decade, after which it ends.
constexpr int steps_per_decade = 4;
constexpr int most_worse_steps = 2;
/// RMS distance between the shapes at two moduli, divided by the length, up to which they belong to
/// the same equilibrium.
constexpr double largest_deviation = 0.1;
/// Shortest step along ln(E*/E). An equilibrium that is lost with it is considered to end.
constexpr double least_step = 0.02;
/// Accuracy of ln(E*/E).
constexpr double log_tolerance = 1e-6;

/// Thrown if the time limit of the whole search is exceeded, or if the thread is interrupted.
struct OutOfTime {};

/// One equilibrium of a scene as a function of the modulus; each solve starts from the nearest
/// known one.
class FollowedState {
 public:
  FollowedState(const Scene& scene, const ShapeDistance& distance,
                const energy_model::Equilibrium& state, const SolveOptions& options)
      : scene_(scene),
        distance_(distance),
        options_(options),
        s_(equal_arc_lengths(scene.length, 41)) {
    remember(0, state);
  }

  /// Returns the mean square distance [m^2]; infinite beyond the end of the equilibrium.
  /// @throws OutOfTime
  double operator()(double log_ratio) {
    const auto known = known_.find(log_ratio);
    if (known != known_.end()) return known->second.mean_square;
    const Known* reached = reach(log_ratio);
    return reached != nullptr ? reached->mean_square : std::numeric_limits<double>::infinity();
  }

  /// Returns the smallest eigenvalue of the second variation; NaN beyond the modulus at which the
  /// equilibrium ceases to exist, or if the solver did not compute it.
  [[nodiscard]] double smallest_eigenvalue(double log_ratio) {
    if (!std::isfinite((*this)(log_ratio))) return NAN;
    return known_.at(log_ratio).state.smallest_eigenvalue;
  }

  [[nodiscard]] int solves() const { return solves_; }

 private:
  struct Known {
    energy_model::Equilibrium state;
    Eigen::Matrix3Xd points;
    double mean_square = 0;
  };

  const Known& remember(double log_ratio, energy_model::Equilibrium state) {
    Known known;
    known.points = state.sample(s_).points;
    const double rms = distance_(state);
    known.mean_square = rms * rms;
    known.state = std::move(state);
    return known_.insert_or_assign(log_ratio, std::move(known)).first->second;
  }

  /// Continues the equilibrium from the nearest known modulus; steps on which it is lost are
  /// halved. Returns null if it ends.
  const Known* reach(double log_ratio) {
    for (double target = log_ratio;;) {
      const auto [from, start] = nearest(target);
      const Known* found = step(*start, target);
      if (found != nullptr && target == log_ratio) return found;
      if (found != nullptr) {
        target = log_ratio;
        continue;
      }
      if (std::abs(target - from) < 2 * least_step) return nullptr;
      target = (from + target) / 2;
    }
  }

  [[nodiscard]] std::pair<double, const Known*> nearest(double log_ratio) const {
    const auto above = known_.lower_bound(log_ratio);
    if (above == known_.begin()) return {above->first, &above->second};
    const auto below = std::prev(above);
    const bool up = above != known_.end() && above->first - log_ratio < log_ratio - below->first;
    return up ? std::pair{above->first, &above->second} : std::pair{below->first, &below->second};
  }

  /// Returns null if the solver finds no equilibrium at the modulus or a different one, or if the
  /// energy model does not support the modulus. @throws OutOfTime
  const Known* step(const Known& start, double log_ratio) {
    SolveOptions options = options_;
    options.start = &start.state;
    options.time_limit -= timer_.seconds();
    if (!(options.time_limit > 0) || energy_model::interrupted()) throw OutOfTime();
    Scene scene = scene_;
    scene.scale_modulus(std::exp(log_ratio));
    ++solves_;
    try {
      energy_model::Equilibrium state = solve_reference(scene, options);
      const double deviation = rms(s_, state.sample(s_).points - start.points);
      if (!(deviation <= largest_deviation * scene_.length)) return nullptr;
      return &remember(log_ratio, std::move(state));
    } catch (const ResultError&) {
      return nullptr;  // not converged, or softer or stiffer than the energy model supports
    }
  }

  Scene scene_;  // at E*/E = 1
  const ShapeDistance& distance_;
  SolveOptions options_;
  std::vector<double> s_;
  std::map<double, Known> known_;
  Timer timer_;
  int solves_ = 0;
};

/// Scans from E*/E = 1 in both directions, each until the RMS distance has not decreased by more
/// than `resolution` [m] for half a decade, the equilibrium ends, or the range of moduli ends.
Scan scan_both_ways(FollowedState& mean_square, double resolution) {
  const double step = std::log(10) / steps_per_decade;
  const int lowest = static_cast<int>(std::round(std::log(smallest_modulus_ratio) / step));
  const int highest = static_cast<int>(std::round(std::log(largest_modulus_ratio) / step));
  std::map<double, double> values;
  for (const int direction : {-1, 1}) {
    double least = std::numeric_limits<double>::infinity();
    int worse = 0;
    for (int i = 0; i >= lowest && i <= highest && worse < most_worse_steps; i += direction) {
      const double value = mean_square(step * i);
      values[step * i] = value;
      const bool less = std::sqrt(value) < std::sqrt(least) - resolution;
      worse = less ? 0 : worse + 1;
      least = std::min(least, value);
      if (!std::isfinite(value)) break;
    }
  }
  Scan result;
  for (const auto& [x, value] : values) {
    result.x.push_back(x);
    result.value.push_back(value);
  }
  return result;
}

EffectiveModulus no_modulus(std::string why) {
  EffectiveModulus result;
  result.missing_reason = std::move(why);
  return result;
}

/// Whether the followed equilibrium ends or bifurcates close to a modulus. At a bifurcation the
/// smallest eigenvalue is zero and increases on both sides; on one side it belongs to another
/// branch. False close to the ends of the range of moduli.
bool is_at_bifurcation(FollowedState& state, double log_ratio) {
  // Equilibria are followed up to this distance from the end of their branch [ln of the modulus].
  constexpr double offset = 2 * least_step;
  constexpr double least_eigenvalue_share = 0.25;
  const double low = log_ratio - offset;
  const double high = log_ratio + offset;
  // Beyond the range of moduli nothing is known.
  const bool in_range =
      low >= std::log(smallest_modulus_ratio) && high <= std::log(largest_modulus_ratio);
  if (!in_range) return false;
  if (!std::isfinite(state(low)) || !std::isfinite(state(high))) return true;
  return std::abs(state.smallest_eigenvalue(log_ratio)) <
         least_eigenvalue_share *
             std::min(state.smallest_eigenvalue(low), state.smallest_eigenvalue(high));
}

EffectiveModulus search(FollowedState& mean_square, double resolution) {
  const Scan values = scan_both_ways(mean_square, resolution);
  const std::size_t best = values.best();
  const auto known = [&](std::size_t at) {
    return at < values.value.size() && std::isfinite(values.value[at]);
  };
  if (!known(best + 1) && !(best > 0 && known(best - 1))) {
    return no_modulus("the equilibrium is lost at moduli near the scene's");
  }
  double largest = 0;
  for (const double value : values.value) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  if (!(std::sqrt(largest) - std::sqrt(values.value[best]) > resolution)) {
    return no_modulus("the shape does not change with E");
  }
  const bool bracketed = values.is_bracketed() && known(best - 1) && known(best + 1);
  const Function function = [&](double x) { return mean_square(x); };
  const Minimum minimum = bracketed ? minimum_near(function, values, log_tolerance)
                                    : Minimum{values.x[best], values.value[best]};
  EffectiveModulus result;
  result.missing_reason.clear();
  result.ratio = std::exp(minimum.x);
  result.rms_m = std::sqrt(minimum.value);
  const double at_nominal = mean_square(0);
  if (std::sqrt(at_nominal) > resolution) {
    result.explained_share = std::max(0.0, 1 - minimum.value / at_nominal);
  }
  result.at_bifurcation = is_at_bifurcation(mean_square, minimum.x);
  if (!bracketed || result.at_bifurcation) {
    result.optimum = Optimum::one_sided;
    return result;
  }
  const double factor = std::log(2.0);
  const double around =
      std::sqrt(std::min(mean_square(minimum.x + factor), mean_square(minimum.x - factor)));
  if (around < 1.1 * result.rms_m || !(around - result.rms_m > resolution)) {
    result.optimum = Optimum::flat;
  } else {
    result.optimum =
        result.explained_share < clear_optimum_share ? Optimum::partial : Optimum::clear;
  }
  return result;
}

}  // namespace

Optimum optimum_given_displacement(const EffectiveModulus& modulus, double movement_m) {
  const bool exceeds_movement = modulus.rms_m > movement_m;
  return modulus.optimum == Optimum::clear && exceeds_movement ? Optimum::partial : modulus.optimum;
}

ShapeDistance distance_from(const Shape& shape) {
  return [shape](const energy_model::Equilibrium& reference) {
    return distance(shape, reference.sample);
  };
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape,
                                       const SolveOptions& options) {
  return fit_effective_modulus(scene, distance_from(shape), solve_reference(scene, options),
                               options);
}

EffectiveModulus fit_effective_modulus(const Scene& scene, const ShapeDistance& distance,
                                       const energy_model::Equilibrium& state,
                                       const SolveOptions& options) {
  FollowedState mean_square(scene, distance, state, options);
  EffectiveModulus result;
  try {
    result = search(mean_square, modulus_resolution * scene.length);
  } catch (const OutOfTime&) {
    result = no_modulus(energy_model::interrupted()
                            ? "interrupted, or out of the time of the whole command"
                            : fmt::format("time limit of {:g} s reached", options.time_limit));
  }
  result.solves = mean_square.solves();
  constexpr int samples = 101;
  const std::vector<double> s = equal_arc_lengths(scene.length, samples);
  result.optimum = optimum_given_displacement(
      result, distance_from_straight(scene, {s, state.sample(s).points}));
  return result;
}

}  // namespace dlo::compare
