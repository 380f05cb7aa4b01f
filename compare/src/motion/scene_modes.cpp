#include "motion/scene_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "motion/moving_scene.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/point_layout.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Improves a solver's shape by Newton's method until it is at rest to rounding.
Eigen::Matrix3Xd converged_points(const Scene& scene, const Discretisation& polygon,
                                  Eigen::Matrix3Xd points) {
  for (const force_model::Grip& grip : polygon.rod.grips) {
    points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  constexpr int most_steps = 50;
  constexpr double at_rest = 1e-9;
  for (int i = 0; i < most_steps; ++i) {
    const force_model::EquilibriumCheck check = force_model::check_equilibrium(polygon.rod, points);
    const double rms = std::sqrt(check.step.colwise().squaredNorm().mean());
    if (!std::isfinite(rms)) break;
    if (rms <= at_rest * scene.length && check.stable) return points;
    points += check.step;
  }
  throw ConvergenceError(fmt::format(
      "{}: the polygon of {} points is not stable where it rests (allowed: other points, law or "
      "c_c)",
      scene.file, polygon.rod.points()));
}

/// Returns the square roots of the masses, in the order of the stiffness matrix.
Eigen::VectorXd square_roots_of_masses(const Eigen::VectorXd& masses) {
  return masses.cwiseSqrt().transpose().replicate<3, 1>().reshaped();
}

/// Returns the displacements of the polygon's free points in a mode of the rod.
Eigen::VectorXd displacements_in_mode(const energy_model::VibrationMode& mode, const Scene& scene,
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
  constexpr int fixed_point_rounds = 20;
  result.least_rate = std::sqrt(stiffest / (4 * point_mass));
  for (int i = 0; i < fixed_point_rounds; ++i) {
    const double c_h = std::exp(-lost / result.least_rate);
    result.least_rate = std::sqrt(stiffest / (2 * (1 + c_h) * point_mass));
  }
  return result;
}

void add_polygon(const Scene& scene, const ModeOptions& options, SceneModes& result) {
  if (scene.prescribes_twist()) {
    result.missing_polygon_reason =
        "grippers twist the rod, and the polygon's frames are not followed here";
    return;
  }
  if (result.tension.value_or(0) != 0) {
    result.missing_polygon_reason = "a polygon at rest does not have the tension of the taut rod";
    return;
  }
  const MovingPolygon polygon = polygon_at_rest(scene, options.solve);
  if (polygon.masses.size() == 0 || !(polygon.masses.minCoeff() > 0)) {
    result.missing_polygon_reason = "a free point of the polygon has no mass";
    return;
  }
  const PolygonModes weighed = polygon_modes(polygon.stiffness, polygon.masses);
  // A step has one c_F, and so the same mass, for all points.
  const PolygonModes equal =
      polygon_modes(polygon.stiffness, Eigen::VectorXd::Ones(polygon.masses.size()));
  result.physical = physical_steps(polygon.masses.mean(), equal.squared_frequencies.tail<1>()[0],
                                   result.modes.front().rod.omega_squared, options);
  std::optional<force_model::StepOptions> step_settings;
  if (scene.force_model.stepper == Stepper::dynamic) {
    step_settings = step_options(scene.force_model, polygon.discretisation);
    result.effective_point_mass = 1 / (options.rate * options.rate * step_settings->c_F);
  }
  for (SceneMode& mode : result.modes) {
    const Eigen::VectorXd movement = displacements_in_mode(mode.rod, scene, polygon);
    if (!(movement.norm() > 0)) continue;
    const PolygonModes::Match match = weighed.nearest(movement);
    mode.polygon_kinetic_share = match.kinetic_share;
    if (match.omega_squared > 0) mode.polygon_omega = std::sqrt(match.omega_squared);
    if (!step_settings) continue;
    mode.stepped = stepped_mode(equal.nearest(movement).omega_squared, step_settings->c_F,
                                step_settings->c_h, options.rate);
  }
}

}  // namespace

MovingPolygon polygon_at_rest(const Scene& scene, const SolveOptions& options) {
  const ForceModelSettings& settings = scene.force_model;
  if (settings.points > most_points_of_modes) {
    throw InputError(fmt::format("{}: force_model.points = {} (allowed here: up to {})", scene.file,
                                 settings.points, most_points_of_modes));
  }
  MovingPolygon result{.discretisation = discretise(scene, settings)};
  const Discretisation& polygon = result.discretisation;
  if (polygon.rod.bending.natural_turns.size() > 0) {
    throw InputError(
        fmt::format("{}: joints of a polygon that are intrinsically curved bend in their plane "
                    "only, so that it has "
                    "no modes out of it (allowed: a rod that is intrinsically straight)",
                    scene.file));
  }
  // The minimiser needs a potential, which the paper's law between unequal segments does not have.
  const Model model = settings.law == BendingLaw::paper ? Model::force : Model::chain;
  const Shape near = solve(scene, model, options).shape;
  result.points = converged_points(scene, polygon, resample(near, polygon.arc_length).points);
  force_model::StiffnessMatrix K = force_model::tangent_stiffness(polygon.rod, result.points);
  result.stiffness = std::move(K.entries);
  result.free = std::move(K.points);
  const PointMasses masses = point_masses(scene, settings);
  result.masses = (masses.rod + masses.hanging)(result.free);
  return result;
}

PolygonModes polygon_modes(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& masses) {
  const Eigen::VectorXd inverse = square_roots_of_masses(masses).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse.asDiagonal() * stiffness *
                                                              inverse.asDiagonal());
  return {masses, solver.eigenvalues(), inverse.asDiagonal() * solver.eigenvectors()};
}

PolygonModes::Match PolygonModes::nearest(const Eigen::VectorXd& movement) const {
  constexpr double tolerance = 1e-6;
  const Eigen::VectorXd weighed = square_roots_of_masses(masses).cwiseAbs2().cwiseProduct(movement);
  const Eigen::VectorXd shares = (shapes.transpose() * weighed).cwiseAbs2() / movement.dot(weighed);
  Match best;
  for (Eigen::Index begin = 0; begin < squared_frequencies.size();) {
    Eigen::Index end = begin + 1;
    while (end < squared_frequencies.size() &&
           squared_frequencies[end] - squared_frequencies[begin] <=
               tolerance * std::abs(squared_frequencies[end])) {
      ++end;
    }
    const double kinetic_share = shares.segment(begin, end - begin).sum();
    if (kinetic_share > best.kinetic_share)
      best = {squared_frequencies.segment(begin, end - begin).mean(), kinetic_share};
    begin = end;
  }
  return best;
}

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
  scene.require_no_couples("the linearised motion");
  SceneModes result;
  energy_model::Vibrations found;
  const energy_model::VibrationOptions step_settings = {
      .count = options.count, .tolerance = 1e-8, .time_limit = options.solve.time_limit};
  try {
    const energy_model::Problem problem = scene_problem(scene);
    if (energy_model::is_held_straight(problem)) {
      if (scene.weight_between(0, scene.length).norm() > 0 || !scene.distributed_loads.empty()) {
        throw InputError(
            fmt::format("{}: the grippers hold the rod straight, so that its weight or load would "
                        "cause an infinite tension (allowed: some slack, or gravity = [0, 0, 0])",
                        scene.file));
      }
      result.tension = options.tension.value_or(0);
      found = energy_model::taut_vibrations(problem, scene_inertia(scene), *result.tension,
                                            step_settings);
    } else if (options.tension) {
      throw InputError(
          fmt::format("{}: tension = {:g} N: the rod's shape determines its tension (allowed: only "
                      "for a rod that clamps hold straight)",
                      scene.file, *options.tension));
    } else {
      const energy_model::Equilibrium shape = solve_reference(scene, Model::energy, options.solve);
      found = energy_model::vibrations(problem, scene_inertia(scene), shape, step_settings);
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
    result.missing_polygon_reason = error.what();
  }
  return result;
}

}  // namespace dlo::compare
