#include "motion/scene_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "motion/polygon_modes.hpp"
#include "motion/scene_inertia.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/point_layout.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Returns the displacements of the polygon's free points in a mode of the rod.
Eigen::VectorXd movement_of(const energy_model::VibrationMode& mode, const Scene& scene,
                            const MovingPolygon& polygon) {
  std::vector<double> on_rod;
  for (const Eigen::Index i : polygon.free) {
    const double at = polygon.discretisation.arc_length[static_cast<std::size_t>(i)];
    on_rod.push_back(std::clamp(at, 0.0, scene.length));
  }
  return mode.shape(on_rod).reshaped();
}

/// Returns the step constants for physical masses.
/// @param stiffest   largest eigenvalue of the polygon's stiffness, with equal masses of 1 kg [N/m]
/// @param slowest    omega_squared of the rod's slowest mode [1/s^2]
PhysicalSteps physical_steps(double point_mass, double stiffest, double slowest,
                             const ModeOptions& options) {
  PhysicalSteps result;
  result.point_mass = point_mass;
  result.c_F = 1 / (options.rate * options.rate * point_mass);
  const double lost = 2 * options.damping * std::sqrt(std::max(0.0, slowest));
  result.c_h = std::exp(-lost / options.rate);
  // |z| <= 1 in Formula 19 if c_F k <= 2 (1 + c_h), where c_h depends on the rate.
  constexpr int rounds = 20;
  result.least_rate = std::sqrt(stiffest / (4 * point_mass));
  for (int i = 0; i < rounds; ++i) {
    const double c_h = std::exp(-lost / result.least_rate);
    result.least_rate = std::sqrt(stiffest / (2 * (1 + c_h) * point_mass));
  }
  return result;
}

void add_polygon(const Scene& scene, const ModeOptions& options, SceneModes& result) {
  if (scene.holds_twist()) {
    result.no_polygon = "grippers twist the rod, and the polygon's frames are not followed here";
    return;
  }
  if (result.tension.value_or(0) != 0) {
    result.no_polygon = "its points are at rest without the rod's tension";
    return;
  }
  const MovingPolygon polygon = polygon_at_rest(scene, options.solve);
  if (polygon.masses.size() == 0 || !(polygon.masses.minCoeff() > 0)) {
    result.no_polygon = "a free point of the polygon has no mass";
    return;
  }
  const PolygonModes weighed = polygon_modes(polygon.stiffness, polygon.masses);
  // A step has one c_F, and so the same mass, for all points.
  const PolygonModes equal =
      polygon_modes(polygon.stiffness, Eigen::VectorXd::Ones(polygon.masses.size()));
  result.physical = physical_steps(polygon.masses.mean(), equal.squares.tail<1>()[0],
                                   result.modes.front().rod.omega_squared, options);
  std::optional<force_model::StepOptions> own;
  if (scene.force_model.stepper == Stepper::dynamic) {
    own = step_options(scene.force_model, polygon.discretisation);
    result.mass_of_steps = 1 / (options.rate * options.rate * own->c_F);
  }
  for (SceneMode& mode : result.modes) {
    const Eigen::VectorXd movement = movement_of(mode.rod, scene, polygon);
    if (!(movement.norm() > 0)) continue;
    const PolygonModes::Match match = weighed.nearest(movement);
    mode.polygon_likeness = match.likeness;
    if (match.square > 0) mode.polygon_omega = std::sqrt(match.square);
    if (!own) continue;
    mode.stepped = stepped_mode(equal.nearest(movement).square, own->c_F, own->c_h, options.rate);
  }
}

}  // namespace

SteppedMode stepped_mode(double stiffness, double c_F, double c_h, double rate) {
  const double middle = (1 + c_h - c_F * stiffness) / 2;
  const std::complex<double> root = std::sqrt(std::complex<double>(middle * middle - c_h));
  SteppedMode mode;
  const double largest = std::max(std::abs(middle + root), std::abs(middle - root));
  mode.is_stable = largest <= 1 + 1e-12;
  if (root.imag() == 0) return mode;
  const std::complex<double> growth = std::log(middle + root) * rate;
  mode.omega = std::abs(growth.imag());
  mode.damping = -growth.real() / std::abs(growth);
  return mode;
}

SceneModes scene_modes(const Scene& scene, const ModeOptions& options) {
  scene.require_no_couples("the linearised motion does");
  SceneModes result;
  energy_model::Vibrations found;
  const energy_model::VibrationOptions own = {
      .count = options.count, .tolerance = 1e-8, .time_limit = options.solve.time_limit};
  try {
    const energy_model::Problem problem = scene_problem(scene);
    if (energy_model::is_held_straight(problem)) {
      if (scene.weight_between(0, scene.length).norm() > 0 || !scene.distributed_loads.empty()) {
        throw InputError(fmt::format(
            "{}: the grippers hold the rod straight, which its weight or load would pull "
            "endlessly (allowed: some slack, or gravity = [0, 0, 0])",
            scene.file));
      }
      result.tension = options.tension.value_or(0);
      found = energy_model::taut_vibrations(problem, scene_inertia(scene), *result.tension, own);
    } else if (options.tension) {
      throw InputError(
          fmt::format("{}: tension = {:g} N: the rod's shape determines its tension "
                      "(allowed: of one that clamps hold straight)",
                      scene.file, *options.tension));
    } else {
      const energy_model::Equilibrium shape = solve_reference(scene, Model::energy, options.solve);
      found = energy_model::vibrations(problem, scene_inertia(scene), shape, own);
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", scene.file, error.what()));
  }
  result.status = found.status;
  result.message = found.message;
  if (found.modes.empty()) {
    throw ConvergenceError(fmt::format("{}: no modes: {}", scene.file, found.message));
  }
  for (energy_model::VibrationMode& mode : found.modes) {
    result.modes.push_back({std::move(mode), std::nullopt, 0, std::nullopt});
  }
  try {
    add_polygon(scene, options, result);
  } catch (const ResultError& error) {
    result.no_polygon = error.what();
  }
  return result;
}

}  // namespace dlo::compare
