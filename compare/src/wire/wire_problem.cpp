#include "wire/wire_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Error of the energy model, divided by the length.
constexpr double own_error = 1e-8;
/// Longest step in log E for which the fit is nearly linear.
constexpr double longest_log_step = 1;
/// Largest last step of fits from which others start, in standard deviations.
constexpr double coarse_step = 0.1;

/// Returns the scenes whose numbers are fitted.
std::vector<Scene> fitted_scenes(const std::vector<Scene>& scenes, const MeasuredShapes& measured,
                                 const MaterialFitOptions& options) {
  std::vector<bool> flat;
  for (std::size_t i = 0; i < scenes.size(); ++i) flat.push_back(measured.is_flat(i));
  return with_said_frames(scenes, flat, options);
}

}  // namespace

WireProblem::WireProblem(const std::vector<Scene>& said, const std::vector<MeasuredShape>& of,
                         MeasuredShapes& against, const MaterialFitOptions& asked,
                         bool with_density)
    : scenes(said), shapes(of), measured(against), options(asked), density(with_density) {
  std::vector<Scene> fitted = fitted_scenes(scenes, measured, options);
  numbers = wire_numbers(fitted, shapes, options, density);
  scene_at = [fitted = std::move(fitted), changes = numbers](std::size_t shape,
                                                             const Eigen::VectorXd& values) {
    Scene result = fitted[shape];
    for (std::size_t k = 0; k < changes.size(); ++k) {
      const std::optional<std::size_t>& whose = changes[k].described.shape;
      if (whose && *whose != shape) continue;
      changes[k].change(result, values[static_cast<Eigen::Index>(k)]);
    }
    return result;
  };
}

Eigen::Index WireProblem::first_of_others() const {
  return 1 + (density ? 1 : 0) + (options.torsional_stiffness ? 1 : 0);
}

FittedRods WireProblem::rods(int terms) const {
  std::vector<Unknown> unknowns;
  unknowns.reserve(numbers.size());
  for (const WireNumber& number : numbers) {
    unknowns.push_back({.stride = number.term < std::max(1, terms) ? number.stride : 0,
                        .shape = number.described.shape,
                        .known_before = number.described.known_before,
                        .longest_step = number.longest_step});
  }
  unknowns.front().longest_step = longest_log_step;
  return {measured, scene_at, std::move(unknowns)};
}

double WireProblem::lowest() const {
  constexpr double ropes_load = 1e5;  // w l^3 / (EI)
  constexpr double two_decades = 1e-2;
  double load = 0;
  for (const Scene& scene : scenes) load = std::max(load, scene.gamma());
  return std::log(std::max(options.smallest_ratio, std::min(load / ropes_load, two_decades)));
}

GaussNewtonOptions WireProblem::steps() const {
  return {.noise = options.noise,
          .least_noise = least_noise(),
          .lowest = lowest(),
          .highest = std::log(options.largest_ratio)};
}

GaussNewtonOptions WireProblem::coarse_steps() const {
  GaussNewtonOptions result = steps();
  result.last_step = coarse_step;
  return result;
}

double WireProblem::least_noise() const { return own_error * scenes.front().length; }

void WireProblem::descend(GaussNewton& fit) const {
  if (fit.descend()) return;
  throw ConvergenceError(
      fmt::format("{}: the energy model has no shape beside the fitted one", scenes.front().file));
}

}  // namespace dlo::compare
