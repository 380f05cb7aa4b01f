#include "dlo/compare/comparison.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::compare {
namespace {

/// Difference of a polygon from the reference along the rod, so that polygons with other points can
/// be set against each other: the difference is smooth where the polygon is not.
Shape difference_field(const Shape& shape, const Reference& reference) {
  return {shape.arc_length, shape.points - reference(shape.arc_length).points};
}

double field_distance(const Shape& a, const Shape& b, const std::vector<double>& s) {
  return rms(s, resample(a, s).points - resample(b, s).points);
}

Budget error_budget(const Scene& scene, const Solution& force, const Reference& reference,
                    const SolveOptions& options) {
  ForceModelSettings settings = scene.force_model;
  // The chain stretches as the material does, so that what a lower c_c adds shows as stretch.
  settings.c_c.reset();
  const auto chain = [&] { return solve_chain(scene, settings, options).shape; };
  const Shape same = chain();
  settings.law = Law::hooke;
  const Shape hooke = settings.law == scene.force_model.law ? same : chain();
  settings.bookkeeping = Bookkeeping::consistent;
  const Shape consistent = settings.bookkeeping == scene.force_model.bookkeeping ? hooke : chain();

  constexpr int field_points = 201;
  const std::vector<double> s = equal_arc_lengths(scene.length, field_points);
  const Shape force_field = difference_field(force.shape, reference);
  const Shape same_field = difference_field(same, reference);
  const Shape hooke_field = difference_field(hooke, reference);
  const Shape consistent_field = difference_field(consistent, reference);
  Budget budget;
  budget.law = field_distance(same_field, hooke_field, s);
  budget.bookkeeping = field_distance(hooke_field, consistent_field, s);
  budget.discretisation = rms(s, resample(consistent_field, s).points);
  budget.stretch = field_distance(force_field, same_field, s);
  budget.not_at_rest = force.remaining_error;
  return budget;
}

/// The end that no gripper holds; of two the one at arc length l.
std::optional<Eigen::Index> free_end(const Scene& scene, const std::vector<double>& s) {
  const auto held = [&](double at) {
    return std::any_of(scene.grippers.begin(), scene.grippers.end(),
                       [at](const Gripper& gripper) { return gripper.at == at; });
  };
  if (!held(scene.length)) return static_cast<Eigen::Index>(s.size()) - 1;
  if (!held(0)) return 0;
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene, const std::vector<double>& s) {
  const Gripper& grip = scene.grippers.front();
  if (scene.grippers.size() > 1 || !grip.direction) return std::nullopt;
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(s.size()));
  for (std::size_t i = 0; i < s.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = grip.position + (s[i] - grip.at) * *grip.direction;
  }
  return points;
}

Deviation shape_deviation(const Scene& scene, const Shape& shape, const Reference& reference) {
  return deviation(shape, reference, straight_rod(scene, shape.arc_length),
                   free_end(scene, shape.arc_length));
}

Comparison compare(const Scene& scene, const SolveOptions& options) {
  Comparison result;
  result.scene = scene.name;
  result.gamma = scene.gamma();
  result.settings = scene.force_model;
  result.force = solve_force(scene, scene.force_model, options);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy, options);
  const std::vector<double>& s = result.force.shape.arc_length;
  result.reference = {s, energy.sample(s).points};
  const std::optional<Eigen::Matrix3Xd> straight = straight_rod(scene, s);
  result.deviation = shape_deviation(scene, result.force.shape, energy.sample);
  result.undeformed_rms_over_length =
      straight ? rms(s, *straight - result.reference.points) / scene.length : NAN;
  result.effective_modulus = fit_effective_modulus(scene, result.force.shape);
  result.budget = error_budget(scene, result.force, energy.sample, options);
  result.energy_seconds = energy.seconds;
  result.energy_evaluations = energy.evaluations;
  return result;
}

}  // namespace dlo::compare
