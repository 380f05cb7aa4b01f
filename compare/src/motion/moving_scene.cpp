#include "motion/moving_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "motion/scene_inertia.hpp"
#include "motion/trajectory_motion.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Returns the numbers of terms to try per interval: the requested one, or the usual one and larger
/// ones in case the integration fails.
std::vector<int> terms_to_try(int asked) {
  if (asked > 0) return {asked};
  return {12, 16, 24, 32};
}

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
  throw InputError(fmt::format("{}: --dynamic: {}", file, why));
}

/// Returns the scene's rod at the first frame, with its masses and the motions of its grips and
/// obstacles.
energy_model::MovingRod moving_rod(const Scene& scene, const std::vector<std::size_t>& obstacles,
                                   const FrameClock& clock, const RodDamping& damping) {
  const Scene first = clock.scene(scene, 0);
  const Scene now = first.holds_twist() ? first : first.without_twist();
  const double begin = clock.time(0);
  energy_model::MovingRod rod;
  rod.problem = frame_problem(now, obstacles);
  rod.inertia = scene_inertia(now);
  rod.material_damping = damping.material;
  rod.air_drag = damping.air;
  rod.quadratic_drag = damping.quadratic + (scene.drag ? scene.drag->normal : 0);
  const auto follow = [&](const Trajectory& way,
                          const std::optional<Eigen::Vector3d>& rolls_about = std::nullopt) {
    for (const double time : trajectory_breaks(way, begin)) rod.breaks.push_back(time);
    return trajectory_motion(way, begin, rolls_about);
  };
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    const bool rolls = now.grippers[i].frame.has_value();
    rod.motions.push_back(
        gripper.trajectory.empty()
            ? energy_model::standing(gripper.position)
            : follow(gripper.trajectory, rolls ? now.grippers[i].direction : std::nullopt));
  }
  for (const std::size_t i : obstacles) {
    const Trajectory& way = scene.obstacles[i].trajectory;
    rod.obstacle_motions.push_back(way.empty() ? nullptr : follow(way));
  }
  return rod;
}

/// Whether a grip or an obstacle has a velocity at the start.
bool begins_in_motion(const energy_model::MovingRod& rod) {
  const auto moves = [](const energy_model::GripMotion& motion) {
    if (!motion) return false;
    const energy_model::GripPose pose = motion(0);
    return !pose.velocity.isZero(0) || !pose.angular_velocity.isZero(0);
  };
  return std::ranges::any_of(rod.motions, moves) ||
         std::ranges::any_of(rod.obstacle_motions, moves);
}

/// Whether the directions of a trajectory's poses differ.
bool changes_direction(const Trajectory& way) {
  return std::ranges::any_of(way.poses(), [&](const Pose& pose) {
    return pose.direction && *pose.direction != *way.poses().front().direction;
  });
}

}  // namespace

std::string SimulatedMotion::why_stopped() const {
  if (moved.status != energy_model::SolveStatus::time_limit) {
    return fmt::format("{} ({} terms; others by --terms)", moved.message, moved.terms);
  }
  return moved.message +
         "; give a longer time limit, or make the simulation faster by more damping or another "
         "number of --terms";
}

void require_dynamic(const Scene& scene) {
  if (scene.holds_twist() || scene.has_material_directors()) {
    for (const Gripper& gripper : scene.grippers) {
      if (!gripper.frame || !changes_direction(gripper.trajectory)) continue;
      refuse(scene.file,
             "a clamp that holds the rod's frame changes its direction, which does not determine "
             "how the frame rotates with it (allowed: positions and rolls that move)");
    }
  }
  scene.require_potential("the moving rod does");
  if (scene.has_couples()) {
    refuse(scene.file, "a load's torque, which has no potential (allowed: forces)");
  }
  if (scene.drag && scene.drag->tangential > 0) {
    refuse(scene.file, "medium.tangential_drag, which the moving rod does not take (allowed: 0)");
  }
  if (!(scene.mass() > 0)) refuse(scene.file, "the rod has no mass (allowed: > 0 kg)");
}

MovingScene::MovingScene(const Scene& scene, const FrameClock& clock, const RodDamping& damping,
                         const SolveOptions& solve, std::optional<MotionStart> start)
    : file_(scene.file), begin_(clock.time(0)), time_limit_(solve.time_limit) {
  require_dynamic(scene);
  obstacles_ = obstacles_ever_in_reach(scene, clock);
  energy_model::Equilibrium rest;
  try {
    rod_ = moving_rod(scene, obstacles_, clock, damping);
    if (start) {
      start_ = std::move(*start);
      in_motion_ = start_.velocities != nullptr;
      return;
    }
    rest = energy_model::solve_energy(rod_.problem, {.terms = solve.terms,
                                                     .max_evaluations = solve.max_evaluations,
                                                     .time_limit = time_limit_});
  } catch (const std::invalid_argument& error) {
    refuse(scene.file, error.what());
  }
  if (!energy_model::succeeded(rest.status)) {
    throw ConvergenceError(fmt::format("{}: at {:g} s the energy model did not converge: {}", file_,
                                       begin_, rest.message));
  }
  start_.shape = std::move(rest.sample);
  in_motion_ = begins_in_motion(rod_);
}

SimulatedMotion MovingScene::run(const std::vector<double>& times, int terms,
                                 double tolerance) const {
  std::vector<double> since;
  since.reserve(times.size());
  for (const double time : times) since.push_back(time - begin_);
  SimulatedMotion result;
  for (const int tried : terms_to_try(terms)) {
    if (result.moved.terms > 0) {
      result.too_few_terms = {result.moved.terms, times[result.moved.frames.size()]};
    }
    const Timer timer;
    try {
      result.moved = energy_model::simulate(rod_, start_.shape, since,
                                            {.terms = tried,
                                             .tolerance = tolerance,
                                             .in_motion = in_motion_,
                                             .velocities = start_.velocities,
                                             .time_limit = time_limit_});
    } catch (const std::invalid_argument& error) {
      refuse(file_, error.what());
    }
    result.seconds = timer.seconds();
    if (result.moved.status != energy_model::SolveStatus::failed) break;
  }
  return result;
}

}  // namespace dlo::compare
