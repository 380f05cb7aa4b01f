#include "solve/states.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

using energy_model::Equilibrium;

/// Whether a state is stable, as far as is known if it is not verified or at a singular point.
bool is_stable(const Equilibrium& state) {
  return succeeded(state.status) || state.status == energy_model::SolveStatus::not_verified ||
         state.status == energy_model::SolveStatus::near_singular;
}

double shapes_apart(const Scene& scene, const Equilibrium& a, const Equilibrium& b) {
  const std::vector<double> s = equal_arc_lengths(scene.length, 41);
  return rms(s, a.sample(s).points - b.sample(s).points);
}

/// Returns the state that has the shape of another one; the end if there is none.
std::vector<Equilibrium>::iterator find_same(const Scene& scene, std::vector<Equilibrium>& states,
                                             const Equilibrium& state) {
  return std::ranges::find_if(states, [&](const Equilibrium& other) {
    return shapes_apart(scene, state, other) < same_shape_tolerance * scene.length;
  });
}

/// Returns d1 of the mirror image of a material frame (d1, d2 = t x d1). The image keeps the
/// direction of d1 at the first clamp. With d1 = a n + b t x n there, e = a d1 - b d2 is the
/// material direction of the normal n, and p = b d1 + a d2 is the other one. A right-handed image
/// with the same grips has -M e and M p in their place. Its strains are then those of the same rod:
/// unchanged about the normal, and with the opposite sign about the other axis and for twist.
Eigen::Matrix3Xd mirrored_d1(const energy_model::Samples& samples, const Eigen::Matrix3d& mirror,
                             double a, double b) {
  Eigen::Matrix3Xd result(3, samples.d1.cols());
  for (Eigen::Index i = 0; i < samples.d1.cols(); ++i) {
    const Eigen::Vector3d d1 = samples.d1.col(i);
    const Eigen::Vector3d t = samples.tangents.col(i);
    result.col(i) = mirror * ((b * b - a * a) * d1 + 2 * a * b * t.cross(d1));
  }
  return result;
}

/// Returns the mirror image of a state in the plane through the first gripper.
Equilibrium mirrored(const Scene& scene, const Equilibrium& state, const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
  const Eigen::Vector3d origin = scene.grippers.front().position;
  Equilibrium result = state;
  // Direction of d1 at the first clamp, if the shape has directors.
  double a = 0;
  double b = 1;
  const std::vector<const Gripper*> along = grippers_by_arc_length(scene);
  const auto clamp = std::find_if(along.begin(), along.end(),
                                  [](const Gripper* gripper) { return gripper->direction; });
  if (clamp != along.end()) {
    const energy_model::Samples clamp_sample = state.sample(std::vector<double>{(*clamp)->at});
    if (clamp_sample.d1.cols() > 0) {
      a = normal.dot(clamp_sample.d1.col(0));
      b = clamp_sample.tangents.col(0).cross(normal).dot(clamp_sample.d1.col(0));
    }
  }
  result.sample = [mirror, origin, a, b, sample = state.sample](std::span<const double> s) {
    energy_model::Samples samples = sample(s);
    samples.points = ((mirror * (samples.points.colwise() - origin)).colwise() + origin).eval();
    samples.d1 = mirrored_d1(samples, mirror, a, b);
    samples.tangents = (mirror * samples.tangents).eval();
    samples.curvature = (mirror * samples.curvature).eval();
    return samples;
  };
  for (Eigen::Vector3d& force : result.obstacles) force = (mirror * force).eval();
  for (energy_model::ContactPart& contact : result.contacts) {
    contact.force = (mirror * contact.force).eval();
    contact.moment = (-(mirror * contact.moment)).eval();  // an axial vector
  }
  for (energy_model::Reaction& grip : result.grips) {
    grip.force = (mirror * grip.force).eval();
    grip.torque = (-(mirror * grip.torque)).eval();  // an axial vector
  }
  for (energy_model::TwistedPart& twist : result.twists) {
    twist.angle = -twist.angle;
    twist.torque = -twist.torque;
  }
  return result;
}

/// Whether a state precedes another in the order of states: stable ones first, then by energy.
bool precedes(const Equilibrium& a, const Equilibrium& b) {
  return std::pair(!is_stable(a), a.energy.total()) < std::pair(!is_stable(b), b.energy.total());
}

}  // namespace

std::vector<Equilibrium> all_equilibria(const Scene& scene, const Equilibrium& lowest,
                                        const SolveOptions& options) {
  std::vector<Equilibrium> states;
  try {
    if (reference_model(scene) == Model::energy) states = reference_states(scene, options);
  } catch (const ConvergenceError&) {
    // The lowest one is known even if the search fails.
  }
  // `lowest` replaces the state found again, because solve() computed it with all digits.
  const auto found_too = find_same(scene, states, lowest);
  if (found_too != states.end()) {
    *found_too = lowest;
  } else {
    states.insert(states.begin(), lowest);
  }
  if (const std::optional<Eigen::Vector3d> normal = scene.plane_normal()) {
    const std::size_t found = states.size();
    for (std::size_t i = 0; i < found; ++i) {
      Equilibrium image = mirrored(scene, states[i], *normal);
      if (find_same(scene, states, image) == states.end()) states.push_back(std::move(image));
    }
  }
  std::stable_sort(states.begin(), states.end(), precedes);
  return states;
}

std::optional<Equilibrium> equilibrium_near(const Scene& scene, const Shape& shape,
                                            const SolveOptions& options) {
  if (shape.arc_length.size() < 2 || reference_model(scene) != Model::energy) return std::nullopt;
  return reference_near(scene, shape, options);
}

std::optional<std::size_t> insert_equilibrium(const Scene& scene, Equilibrium state,
                                              std::vector<Equilibrium>& states) {
  if (!succeeded(state.status)) return std::nullopt;
  if (find_same(scene, states, state) != states.end()) return std::nullopt;
  const auto at = std::upper_bound(states.begin(), states.end(), state, precedes);
  const auto index = static_cast<std::size_t>(at - states.begin());
  states.insert(at, std::move(state));
  return index;
}

ComparedEquilibrium describe_state(const Scene& scene, const std::vector<Equilibrium>& states,
                                   std::size_t compared, const std::vector<double>& from_shape) {
  ComparedEquilibrium result;
  result.searched = reference_model(scene) == Model::energy;
  result.energy_J = states[compared].energy.total();
  result.rms_from_shape_m = from_shape[compared];
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

Solution solution_in_space(Solution solution, const PlaneTransform& turn) {
  const auto back = [&turn](Eigen::Vector3d& vector) { vector = turn.vectors_to_space(vector); };
  solution.shape.points = turn.points_to_space(solution.shape.points);
  if (solution.to_rest.cols() > 0) solution.to_rest = turn.vectors_to_space(solution.to_rest);
  for (GripperLoad& load : solution.grippers) {
    back(load.force);
    back(load.torque);
  }
  for (Eigen::Vector3d& force : solution.obstacles) back(force);
  return solution;
}

}  // namespace dlo::compare
