#include "released/released_rod.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "motion/frame_clock.hpp"
#include "motion/moving_scene.hpp"
#include "motion/scene_inertia.hpp"

namespace dlo::compare {
namespace {

void require_released(const ReleasedRod& rod) {
  require_dynamic(rod.scene);
  const Scene& scene = rod.scene;
  const bool moves = std::ranges::any_of(
      scene.grippers, [](const Gripper& gripper) { return !gripper.trajectory.empty(); });
  if (moves || !scene.obstacles.empty() || !rod.begin.obstacles.empty()) {
    throw InputError(fmt::format(
        "{}: a released rod (allowed: grippers that stand, and no obstacles)", scene.file));
  }
  if (scene.length != rod.begin.length || scene.grippers.size() != rod.begin.grippers.size()) {
    throw InputError(fmt::format(
        "{}: begin: another rod than that of {} (allowed: the same length and grippers)",
        rod.begin.file, scene.file));
  }
}

}  // namespace

double largest_distance(const std::vector<Eigen::Matrix3Xd>& a,
                        const std::vector<Eigen::Matrix3Xd>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, (a[i] - b[i]).colwise().norm().maxCoeff());
  }
  return most;
}

energy_model::StartingShape released_shape(const ReleasedRod& rod, const SolveOptions& options) {
  require_released(rod);
  return solve_reference(rod.begin, Model::energy, options).sample;
}

ReleasedMotion release_rod(const ReleasedRod& rod, const std::vector<double>& times,
                           const std::vector<double>& arc_length, int terms,
                           const SolveOptions& options) {
  const energy_model::StartingShape start = released_shape(rod, options);
  energy_model::MovingRod moving;
  try {
    moving.problem = frame_problem(rod.scene, {});
    moving.inertia = scene_inertia(rod.scene);
    const energy_model::Dynamics moved = energy_model::simulate(
        moving, start, times, {.terms = terms, .time_limit = options.time_limit});
    if (moved.frames.size() < times.size()) {
      throw ConvergenceError(fmt::format("{}: stopped at {:g} s: {}", rod.scene.file,
                                         times[moved.frames.size()], moved.message));
    }
    ReleasedMotion result{.terms = moved.terms, .step_error = moved.error_estimate};
    result.frames.reserve(times.size());
    for (const energy_model::MovingFrame& frame : moved.frames) {
      result.frames.push_back(frame.sample(arc_length).points);
    }
    return result;
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", rod.scene.file, error.what()));
  }
}

}  // namespace dlo::compare
