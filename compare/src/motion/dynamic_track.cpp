#include "motion/dynamic_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/energy.hpp"
#include "motion/frame_clock.hpp"
#include "motion/scene_inertia.hpp"
#include "motion/trajectory_motion.hpp"
#include "scene/reach.hpp"

namespace dlo::compare {
namespace {

/// Of each piece: those that are asked for, else what is usual, and more where that stops.
std::vector<int> terms_to_try(int asked) {
  if (asked > 0) return {asked};
  return {12, 16, 24, 32};
}

[[noreturn]] void refuse(const Scene& scene, const std::string& why) {
  throw InputError(fmt::format("{}: --dynamic: {}", scene.file, why));
}

FrameClock clock_of(const Scene& scene, const TrackOptions& options) {
  return {scene, {options.from, options.to}, options.rates};
}

/// The scene's rod at the first frame, with its masses and the ways of its grips and obstacles.
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

/// Whether something has a velocity at the begin.
bool begins_in_motion(const energy_model::MovingRod& rod) {
  const auto moves = [](const energy_model::GripMotion& motion) {
    if (!motion) return false;
    const energy_model::GripPose pose = motion(0);
    return !pose.velocity.isZero(0) || !pose.angular_velocity.isZero(0);
  };
  return std::ranges::any_of(rod.motions, moves) ||
         std::ranges::any_of(rod.obstacle_motions, moves);
}

/// Whether its directions are not all the same.
bool changes_direction(const Trajectory& way) {
  return std::ranges::any_of(way.poses(), [&](const Pose& pose) {
    return pose.direction && *pose.direction != *way.poses().front().direction;
  });
}

void add_errors(const std::vector<DynamicFrame>& frames, DynamicTrack& result) {
  const auto take = [](TrackErrors& errors, double error, double time) {
    errors.mean += error;
    if (!(error > errors.largest)) return;
    errors.largest = error;
    errors.largest_time = time;
  };
  TrackErrors force;
  double followed = 0;
  for (const DynamicFrame& frame : frames) {
    take(result.quasi_static, frame.quasi_static_error, frame.time);
    if (!frame.force_error) continue;
    take(force, *frame.force_error, frame.time);
    ++followed;
  }
  result.quasi_static.mean /= static_cast<double>(frames.size());
  if (!(followed > 0)) return;
  force.mean /= followed;
  result.force = force;
}

/// Why the simulation ended early, with what lets it go on.
std::string why_stopped(const energy_model::Dynamics& moved) {
  if (moved.status != energy_model::SolveStatus::time_limit) {
    return fmt::format("{} ({} terms; others by --terms)", moved.message, moved.terms);
  }
  return moved.message +
         "; a longer one lets it go on, more damping or another number of --terms makes it faster";
}

/// Of the frames at equal times that have the force model beside them.
void add_lag(const Track& track, double length, double step, DynamicTrack& result) {
  std::vector<Eigen::Matrix3Xd> leader;
  std::vector<Eigen::Matrix3Xd> follower;
  for (std::size_t i = 0; i < result.frames.size() && track.frames[i].force; ++i) {
    leader.push_back(result.frames[i].points);
    follower.push_back(track.frames[i].force->points);
  }
  if (leader.empty()) return;
  const Lag lag = lag_of(leader, follower, step);
  result.force_lag = lag.time;
  result.force_error_without_lag = lag.rms / length;
}

DynamicFrame frame_of(const energy_model::MovingFrame& moving, const TrackFrame& at_rest,
                      const std::vector<double>& arc_length) {
  const double length = arc_length.back();
  DynamicFrame frame;
  frame.time = at_rest.time;
  frame.energy = moving.energy;
  for (const energy_model::Reaction& reaction : moving.grips) {
    frame.grippers.push_back({reaction.force, reaction.torque});
  }
  frame.points = moving.sample(arc_length).points;
  frame.quasi_static_error = rms(arc_length, at_rest.shape.points - frame.points) / length;
  if (at_rest.force) frame.force_error = distance(at_rest.force->shape, moving.sample) / length;
  return frame;
}

}  // namespace

void require_dynamic(const Scene& scene) {
  if (scene.holds_twist() || scene.has_material_directors()) {
    for (const Gripper& gripper : scene.grippers) {
      if (!gripper.frame || !changes_direction(gripper.trajectory)) continue;
      refuse(scene,
             "a clamp that holds the rod's frame changes its direction, which leaves open how the "
             "frame goes with it (allowed: positions and rolls that move)");
    }
  }
  scene.require_potential("the moving rod does");
  if (scene.has_couples()) {
    refuse(scene, "a load's torque, which has no potential (allowed: forces)");
  }
  if (!(scene.mass() > 0)) refuse(scene, "the rod has no mass (allowed: > 0 kg)");
}

DynamicTrack dynamic_track(const Scene& scene, const Track& track, const TrackOptions& options,
                           const RodDamping& damping) {
  require_dynamic(scene);
  const FrameClock clock = clock_of(scene, options);
  const std::vector<std::size_t> obstacles = obstacles_ever_in_reach(scene, clock);
  DynamicTrack result;
  result.damping = damping;
  result.stopped = track.stopped;
  const double limit = options.solve.time_limit;
  std::vector<double> times;
  for (const TrackFrame& frame : track.frames) times.push_back(frame.time - clock.time(0));
  energy_model::Dynamics moved;
  energy_model::Dynamics coarse;
  try {
    const energy_model::MovingRod rod = moving_rod(scene, obstacles, clock, damping);
    const energy_model::Equilibrium rest =
        energy_model::solve_energy(rod.problem, {.terms = options.solve.terms,
                                                 .max_evaluations = options.solve.max_evaluations,
                                                 .time_limit = limit});
    if (!energy_model::succeeded(rest.status)) {
      throw ConvergenceError(fmt::format("{}: at {:g} s the energy model did not converge: {}",
                                         scene.file, clock.time(0), rest.message));
    }
    result.in_motion = begins_in_motion(rod);
    const auto simulated = [&](int terms) {
      return energy_model::simulate(
          rod, rest.sample, times,
          {.terms = terms, .in_motion = result.in_motion, .time_limit = limit});
    };
    for (const int terms : terms_to_try(options.solve.terms)) {
      if (result.terms > 0) {
        result.too_few_terms = {result.terms, track.frames[moved.frames.size()].time};
      }
      const auto begin = std::chrono::steady_clock::now();
      moved = simulated(terms);
      result.terms = terms;
      result.seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      if (moved.status != energy_model::SolveStatus::failed) break;
    }
    result.fewer_terms = std::max(1, result.terms * 2 / 3);
    coarse = simulated(result.fewer_terms);
  } catch (const std::invalid_argument& error) {
    refuse(scene, error.what());
  }
  if (moved.frames.size() < times.size()) {
    result.stopped = {track.frames[moved.frames.size()].time, why_stopped(moved)};
  }
  if (moved.frames.empty()) {
    throw ConvergenceError(fmt::format("{}: --dynamic: {}", scene.file, why_stopped(moved)));
  }
  result.steps = moved.steps;
  result.energy_error = moved.energy_error;
  result.largest_energy = moved.largest_energy;
  result.step_error = moved.error_estimate;
  const bool rigid = std::any_of(obstacles.begin(), obstacles.end(), [&](std::size_t i) {
    return std::isinf(scene.obstacles[i].stiffness);
  });
  if (rigid) result.deepest_contact = moved.deepest_contact / scene.length;
  for (std::size_t i = 0; i < moved.frames.size(); ++i) {
    result.frames.push_back(frame_of(moved.frames[i], track.frames[i], track.arc_length));
    result.frames.back().obstacles = forces_of_all(scene, obstacles, moved.frames[i].obstacles);
  }
  const SceneEnergies& zero = track.frames.front().energy;
  const energy_model::EnergyBalance first = result.frames.front().energy;
  for (DynamicFrame& frame : result.frames) {
    frame.energy.gravity += zero.gravity - first.gravity;
    frame.energy.load += zero.load - first.load;
  }
  if (coarse.frames.size() < moved.frames.size()) {
    result.term_difference = std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < std::min(moved.frames.size(), coarse.frames.size()); ++i) {
    const Eigen::Matrix3Xd apart =
        coarse.frames[i].sample(track.arc_length).points - result.frames[i].points;
    result.term_difference =
        std::max(result.term_difference, rms(track.arc_length, apart) / scene.length);
  }
  add_errors(result.frames, result);
  add_lag(track, scene.length, 1 / options.rates.frames, result);
  return result;
}

TrackResult follow(const Scene& scene, const TrackRequest& request, const Progress& progress) {
  TrackOptions options = request.options;
  options.rates = {
      .frames = request.frame_rate.value_or(scene.track.frames),
      .obstacles = request.obstacle_rate ? request.obstacle_rate : scene.track.obstacles,
      .steps = request.step_rate.value_or(scene.track.steps)};
  constexpr double most = 1e9;
  const auto rate = [](double value) { return value > 0 && value <= most; };
  if (!rate(options.rates.frames) || !rate(options.rates.steps) ||
      !rate(options.rates.obstacles.value_or(1)) || options.samples < 2) {
    throw InputError("track: out of range (allowed: rates > 0, up to 1e9 Hz, samples >= 2)");
  }
  if (request.damping) require_dynamic(scene);
  TrackResult result{options, {}, {}};
  result.track = track(scene, result.options, progress);
  if (request.damping) {
    result.dynamic = dynamic_track(scene, result.track, result.options, *request.damping);
  }
  return result;
}

}  // namespace dlo::compare
