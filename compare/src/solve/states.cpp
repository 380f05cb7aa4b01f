#include "solve/states.hpp"

#include <algorithm>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/reference.hpp"

namespace dlo::compare {
namespace {

using energy_model::Equilibrium;

/// Stable, as far as is known of a shape that is not resolved or that a fold leaves open.
bool is_stable(const Equilibrium& state) {
  return succeeded(state.status) || state.status == energy_model::SolveStatus::not_resolved ||
         state.status == energy_model::SolveStatus::near_singular;
}

/// Shapes that are nearer than this share of the length are the same.
constexpr double same_shape = 1e-4;

double shapes_apart(const Scene& scene, const Equilibrium& a, const Equilibrium& b) {
  const std::vector<double> s = equal_arc_lengths(scene.length, 41);
  return rms(s, a.sample(s).points - b.sample(s).points);
}

/// The mirror image in the plane through the first gripper.
Equilibrium mirrored(const Scene& scene, const Equilibrium& state, const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
  const Eigen::Vector3d origin = scene.grippers.front().position;
  Equilibrium result = state;
  result.sample = [mirror, origin, sample = state.sample](std::span<const double> s) {
    energy_model::Samples samples = sample(s);
    samples.points = ((mirror * (samples.points.colwise() - origin)).colwise() + origin).eval();
    samples.tangents = (mirror * samples.tangents).eval();
    samples.curvature = (mirror * samples.curvature).eval();
    return samples;
  };
  for (Eigen::Vector3d& force : result.obstacles) force = (mirror * force).eval();
  for (energy_model::ContactPart& contact : result.contacts) {
    contact.force = (mirror * contact.force).eval();
  }
  for (energy_model::Reaction& grip : result.grips) {
    grip.force = (mirror * grip.force).eval();
    grip.torque = (-(mirror * grip.torque)).eval();  // an axial vector
  }
  return result;
}

}  // namespace

std::vector<Equilibrium> all_states(const Scene& scene, const Equilibrium& lowest,
                                    const SolveOptions& options) {
  std::vector<Equilibrium> states = reference_states(scene, options);
  const auto known = [&](const Equilibrium& state) {
    return std::any_of(states.begin(), states.end(), [&](const Equilibrium& other) {
      return shapes_apart(scene, state, other) < same_shape * scene.length;
    });
  };
  if (!known(lowest)) states.insert(states.begin(), lowest);
  if (const std::optional<Eigen::Vector3d> normal = scene.plane_normal()) {
    const std::size_t found = states.size();
    for (std::size_t i = 0; i < found; ++i) {
      Equilibrium image = mirrored(scene, states[i], *normal);
      if (!known(image)) states.push_back(std::move(image));
    }
  }
  std::stable_sort(states.begin(), states.end(), [](const Equilibrium& a, const Equilibrium& b) {
    const bool a_stable = is_stable(a);
    const bool b_stable = is_stable(b);
    if (a_stable != b_stable) return a_stable;
    return a.energy.total() < b.energy.total();
  });
  return states;
}

ComparedState describe_state(const Scene& scene, const std::vector<Equilibrium>& states,
                             std::size_t compared, const std::vector<double>& from_shape) {
  ComparedState result;
  result.energy_J = states[compared].energy.total();
  result.stable = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool stable = is_stable(states[i]);
    ++(stable ? result.stable : result.unstable);
    if (i == compared) {
      result.rank = result.stable;
      continue;
    }
    result.others.push_back(
        {.stable = stable,
         .energy_difference_J = states[i].energy.total() - result.energy_J,
         .rms_from_compared_m = shapes_apart(scene, states[i], states[compared]),
         .rms_from_shape_m = from_shape[i]});
  }
  return result;
}

}  // namespace dlo::compare
