#include "motion/dynamic_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "motion/frame_clock.hpp"
#include "motion/motion_misfit.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

FrameClock clock_of(const Scene& scene, const TrackOptions& options) {
  return {scene, {options.from, options.to}, options.rates};
}

void add_errors(const Track& track, double length, double step, DynamicTrack& result) {
  ForceErrors force;
  std::vector<Eigen::Matrix3Xd> leader;
  std::vector<Eigen::Matrix3Xd> follower;
  for (std::size_t i = 0; i < result.frames.size(); ++i) {
    const DynamicFrame& frame = result.frames[i];
    result.quasi_static.add(frame.quasi_static_error, frame.time);
    if (!frame.force_error) continue;
    force.add(*frame.force_error, frame.time);
    leader.push_back(frame.points);
    follower.push_back(track.frames[i].force->points);
  }
  result.quasi_static.mean /= static_cast<double>(result.frames.size());
  if (leader.empty()) return;
  force.finish(leader, follower, step, length);
  result.force = force;
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

DynamicTrack dynamic_track(const Scene& scene, const Track& track, const TrackOptions& options,
                           const RodDamping& damping) {
  const FrameClock clock = clock_of(scene, options);
  require_dynamic(scene);
  const MovingScene moving(scene, clock, damping, options.solve,
                           given_start(scene, clock.time(0), damping, options.solve));
  DynamicTrack result;
  result.damping = damping;
  result.in_motion = moving.in_motion();
  result.stopped = track.stopped;
  std::vector<double> times;
  for (const TrackFrame& frame : track.frames) times.push_back(frame.time);
  const SimulatedMotion run = moving.run(times, options.solve.terms);
  const energy_model::Dynamics& moved = run.moved;
  result.terms = moved.terms;
  result.too_few_terms = run.too_few_terms;
  result.seconds = run.seconds;
  result.fewer_terms = std::max(1, result.terms * 2 / 3);
  const energy_model::Dynamics coarse = moving.run(times, result.fewer_terms).moved;
  if (moved.frames.size() < times.size()) {
    result.stopped = {times[moved.frames.size()], run.stop_reason()};
  }
  if (moved.frames.empty()) {
    throw ConvergenceError(fmt::format("{}: --dynamic: {}", scene.file, run.stop_reason()));
  }
  result.steps = moved.steps;
  result.energy_error = moved.energy_error;
  result.largest_energy = moved.largest_energy;
  result.step_error = moved.error_estimate;
  const bool rigid = std::ranges::any_of(
      moving.obstacles(), [&](std::size_t i) { return std::isinf(scene.obstacles[i].stiffness); });
  if (rigid) result.deepest_contact = moved.deepest_contact / scene.length;
  for (std::size_t i = 0; i < moved.frames.size(); ++i) {
    result.frames.push_back(frame_of(moved.frames[i], track.frames[i], track.arc_length));
    result.frames.back().obstacles =
        expand_obstacle_forces(scene, moving.obstacles(), moved.frames[i].obstacles);
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
    const Eigen::Matrix3Xd difference =
        coarse.frames[i].sample(track.arc_length).points - result.frames[i].points;
    result.term_difference =
        std::max(result.term_difference, rms(track.arc_length, difference) / scene.length);
  }
  add_errors(track, scene.length, 1 / options.rates.frame_rate, result);
  return result;
}

TrackResult follow(const Scene& scene, const TrackRequest& request, const Progress& progress) {
  TrackOptions options = request.options;
  options.rates = {
      .frame_rate = request.frame_rate.value_or(scene.track.frame_rate),
      .obstacle_rate = request.obstacle_rate ? request.obstacle_rate : scene.track.obstacle_rate,
      .step_rate = request.step_rate.value_or(scene.track.step_rate)};
  constexpr double largest_rate = 1e9;
  const auto rate = [](double value) { return value > 0 && value <= largest_rate; };
  if (!rate(options.rates.frame_rate) || !rate(options.rates.step_rate) ||
      !rate(options.rates.obstacle_rate.value_or(1)) || options.samples < 2) {
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
