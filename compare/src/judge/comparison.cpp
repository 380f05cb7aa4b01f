#include "dlo/compare/comparison.hpp"

#include <algorithm>
#include <limits>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "polygon/natural_plane.hpp"
#include "scene/scene_problem.hpp"
#include "solve/states.hpp"

namespace dlo::compare {
namespace {

/// Returns the index of the state nearest to the shape to which the Hookean polygon relaxes from
/// the force model's shape; saddles are excluded. Returns 0 if there is only one state.
std::size_t state_of(const Scene& scene, const Shape& force,
                     const std::vector<energy_model::Equilibrium>& states,
                     const SolveOptions& options) {
  if (states.size() == 1) return 0;
  ForceModelSettings settings = scene.force_model;
  settings.law = BendingLaw::hooke;
  // The force model without twist is compared with a relaxed shape without twist.
  const bool twisted = models_twist(scene, scene.force_model);
  const Shape downhill =
      chain_from(twisted ? scene : scene.without_twist(), settings, force, options);
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].status == energy_model::SolveStatus::saddle) continue;
    const double separation = distance(downhill, states[i].sample);
    if (separation >= least) continue;
    least = separation;
    nearest = i;
  }
  return nearest;
}

/// Adds the equilibrium that a search from the force model's points finds, if it is stable and not
/// yet known. Does not search if a stable known state is within `nearest_shape_tolerance` of these
/// points.
void add_state_of_force_model(const Scene& scene, const Shape& force, const SolveOptions& options,
                              std::vector<energy_model::Equilibrium>& states) {
  const bool is_near = std::any_of(states.begin(), states.end(), [&](const auto& state) {
    return succeeded(state.status) &&
           distance(force, state.sample) < nearest_shape_tolerance * scene.length;
  });
  if (is_near) return;
  if (std::optional<energy_model::Equilibrium> near = equilibrium_near(scene, force, options)) {
    (void)insert_equilibrium(scene, *std::move(near), states);
  }
}

}  // namespace

Comparison compare(const Scene& scene, const SolveOptions& options,
                   const std::optional<PlanOptions>& plan, ModulusSearch modulus) {
  Comparison result;
  result.scene = scene.name;
  result.gamma = scene.gamma();
  result.length = scene.length;
  result.stiffness = scene.stiffness();
  result.settings = scene.force_model;
  if (plan) result.plan = make_plan(scene, *plan);
  result.force = solve_force(scene, scene.force_model, options);
  const Shape& force = result.force.shape;
  // The cost is that of the call that a user would make; the search for other states is not
  // counted.
  const energy_model::Equilibrium lowest = solve_reference(scene, options);
  result.energy_seconds = lowest.seconds;
  result.energy_evaluations = lowest.evaluations;
  std::vector<energy_model::Equilibrium> states = all_equilibria(scene, lowest, options);
  add_state_of_force_model(scene, force, options, states);
  const std::size_t compared = state_of(scene, force, states, options);
  const energy_model::Equilibrium& energy = states[compared];
  std::vector<double> from_force;
  const ShapeDistance distance = distance_from(force);
  from_force.reserve(states.size());
  for (const energy_model::Equilibrium& state : states) from_force.push_back(distance(state));
  result.state = describe_state(scene, states, compared, from_force);
  if (!energy_model::succeeded(energy.status)) result.unverified = energy.message;

  const std::vector<double>& s = force.arc_length;
  result.reference = {s, energy.sample(s).points};
  result.reference_rod = energy.sample;
  result.contacts = contacts_of(scene, energy);
  if (has_friction_contact(
          scene, expand_obstacle_forces(scene, obstacles_in_reach(scene), energy.obstacles)) &&
      !has_friction_contact(scene, result.force.obstacles)) {
    result.force.neglected.emplace_back("friction");
  }
  result.deviation = shape_deviation(scene, force, energy.sample);
  result.undeformed_rms_over_length =
      distance_from_straight(scene, result.reference) / scene.length;
  if (modulus == ModulusSearch::yes && result.unverified.empty()) {
    result.effective_modulus = fit_effective_modulus(scene, distance, energy, options);
  }
  result.residual_over_displacement =
      result.deviation.rms_over_movement / result.deviation.rms_m * result.effective_modulus.rms_m;
  // The deflection is the one reported, at the force model's points.
  result.effective_modulus.optimum = optimum_given_displacement(
      result.effective_modulus, result.effective_modulus.rms_m / result.residual_over_displacement);
  result.budget = error_budget(scene, result.force, energy.sample, options);
  return result;
}

}  // namespace dlo::compare
