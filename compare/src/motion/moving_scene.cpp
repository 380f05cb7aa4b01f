#include "motion/moving_scene.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/error.hpp"
#include "scene/scene_problem.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Relative rounding of times, as the integrator's own units cause it [-]. The integrator requests
/// values after a pose at 1e-12 beyond it.
constexpr double time_rounding = 1e-14;

/// A leg of a trajectory, and the rotation of its directions at its start.
struct TurnedLeg {
  TrajectoryLeg leg;
  Eigen::Quaterniond first_rotation;
};

/// Direction and roll of a rolling clamp at time zero.
struct RollingClamp {
  Eigen::Vector3d direction;
  double roll;
};

/// Returns the legs of a trajectory, with time zero at `begin`.
std::vector<TurnedLeg> turned_legs(const Trajectory& trajectory, double begin) {
  std::vector<Pose> poses = trajectory.poses();
  for (Pose& pose : poses) pose.time -= begin;
  std::vector<TurnedLeg> result;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const TrajectoryLeg leg = leg_after(poses, i);
    result.push_back({leg, turn});
    turn = Eigen::Quaterniond(Eigen::AngleAxisd(leg.angle, leg.axis)) * turn;
  }
  return result;
}

energy_model::GripPose pose_on(const TurnedLeg& turned, const std::optional<RollingClamp>& first,
                               double time) {
  const TrajectoryLeg& leg = turned.leg;
  energy_model::GripPose pose;
  pose.position = leg.position(time);
  pose.velocity = leg.position(time, 1);
  pose.acceleration = leg.position(time, 2);
  pose.turn =
      Eigen::Quaterniond(Eigen::AngleAxisd(leg.turned(time), leg.axis)) * turned.first_rotation;
  pose.angular_velocity = leg.turned(time, 1) * leg.axis;
  pose.angular_acceleration = leg.turned(time, 2) * leg.axis;
  if (!first) return pose;
  const Eigen::Vector3d about = (pose.turn * first->direction).normalized();
  const double rate = leg.rolled(time, 1);
  pose.turn = Eigen::AngleAxisd(leg.rolled(time) - first->roll, about) * pose.turn;
  pose.angular_acceleration +=
      leg.rolled(time, 2) * about + rate * pose.angular_velocity.cross(about);
  pose.angular_velocity += rate * about;
  return pose;
}

/// Returns a pose without velocities and accelerations.
energy_model::GripPose pose_at_rest(const energy_model::GripPose& end) {
  energy_model::GripPose pose;
  pose.position = end.position;
  pose.turn = end.turn;
  return pose;
}

energy_model::GripPose pose_on_legs(const std::vector<TurnedLeg>& legs,
                                    const std::optional<RollingClamp>& first, double time) {
  const double earlier = time - time_rounding * std::abs(time);
  const auto leg =
      std::lower_bound(legs.begin(), legs.end(), earlier,
                       [](const TurnedLeg& turned, double t) { return turned.leg.to.time < t; });
  if (leg == legs.end()) return pose_at_rest(pose_on(legs.back(), first, legs.back().leg.to.time));
  if (!(earlier > leg->leg.from.time)) {
    return pose_at_rest(pose_on(legs.front(), first, legs.front().leg.from.time));
  }
  return pose_on(*leg, first, time);
}

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
  const Scene now = first.prescribes_twist() ? first : first.without_twist();
  const double begin = clock.time(0);
  energy_model::MovingRod rod;
  rod.problem = frame_problem(now, obstacles);
  rod.inertia = scene_inertia(now);
  rod.material_damping = damping.material;
  rod.air_drag = damping.air;
  rod.quadratic_drag = damping.quadratic + (scene.drag ? scene.drag->normal : 0);
  const auto follow = [&](const Trajectory& trajectory,
                          const std::optional<Eigen::Vector3d>& rolls_about = std::nullopt) {
    for (const double time : trajectory_breaks(trajectory, begin)) rod.breaks.push_back(time);
    return trajectory_motion(trajectory, begin, rolls_about);
  };
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    const bool rolls = now.grippers[i].frame.has_value();
    rod.motions.push_back(
        gripper.trajectory.empty()
            ? energy_model::fixed_grip(gripper.position)
            : follow(gripper.trajectory, rolls ? now.grippers[i].direction : std::nullopt));
  }
  for (const std::size_t i : obstacles) {
    const Trajectory& trajectory = scene.obstacles[i].trajectory;
    rod.obstacle_motions.push_back(trajectory.empty() ? nullptr : follow(trajectory));
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
bool changes_direction(const Trajectory& trajectory) {
  return std::ranges::any_of(trajectory.poses(), [&](const Pose& pose) {
    return pose.direction && *pose.direction != *trajectory.poses().front().direction;
  });
}

}  // namespace

energy_model::Inertia scene_inertia(const Scene& scene) {
  energy_model::Inertia inertia;
  inertia.mass_per_length = scene.mass_per_length();
  for (const Section& section : scene.sections) {
    inertia.of_sections.push_back(section.mass_per_length);
  }
  for (const PointLoad& load : scene.loads) {
    if (load.mass > 0) inertia.point_masses.push_back({load.at, load.mass});
  }
  return inertia;
}

energy_model::GripMotion trajectory_motion(const Trajectory& trajectory, double begin,
                                           const std::optional<Eigen::Vector3d>& rolls_about) {
  if (trajectory.poses().size() == 1)
    return energy_model::fixed_grip(trajectory.poses().front().position);
  std::vector<TurnedLeg> legs = turned_legs(trajectory, begin);
  const Eigen::Quaterniond before = pose_on_legs(legs, std::nullopt, 0).turn;
  for (TurnedLeg& turned : legs) turned.first_rotation *= before.conjugate();
  std::optional<RollingClamp> first;
  const std::optional<double> roll = trajectory.pose_at(begin).roll;
  if (roll && rolls_about) first = RollingClamp{*rolls_about, *roll};
  return [legs = std::move(legs), first](double time) { return pose_on_legs(legs, first, time); };
}

std::vector<double> trajectory_breaks(const Trajectory& trajectory, double begin) {
  std::vector<double> result;
  for (const Pose& pose : trajectory.poses()) result.push_back(pose.time - begin);
  return result;
}

std::string SimulatedMotion::stop_reason() const {
  if (moved.status != energy_model::SolveStatus::time_limit) {
    return fmt::format("{} ({} terms; others by --terms)", moved.message, moved.terms);
  }
  return moved.message +
         "; give a longer time limit, or make the simulation faster by more damping or another "
         "number of --terms";
}

void require_dynamic(const Scene& scene) {
  if (scene.prescribes_twist() || scene.has_material_directors()) {
    for (const Gripper& gripper : scene.grippers) {
      if (!gripper.frame || !changes_direction(gripper.trajectory)) continue;
      refuse(scene.file,
             "a clamp that holds the rod's frame changes its direction, which does not determine "
             "how the frame rotates with it (allowed: positions and rolls that move)");
    }
  }
  scene.require_potential("the rod with inertia");
  if (scene.has_couples()) {
    refuse(scene.file, "load.torque: not supported by the rod with inertia (allowed: forces)");
  }
  if (scene.drag && scene.drag->tangential > 0) {
    refuse(scene.file,
           "medium.tangential_drag: not supported by the rod with inertia (allowed: 0)");
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
  std::vector<double> elapsed;
  elapsed.reserve(times.size());
  for (const double time : times) elapsed.push_back(time - begin_);
  SimulatedMotion result;
  for (const int tried : terms_to_try(terms)) {
    if (result.moved.terms > 0) {
      result.too_few_terms = {result.moved.terms, times[result.moved.frames.size()]};
    }
    const Timer timer;
    try {
      result.moved = energy_model::simulate(rod_, start_.shape, elapsed,
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
