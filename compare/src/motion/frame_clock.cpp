#include "motion/frame_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dlo/compare/error.hpp"
#include "polygon/energy_problems.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {

std::optional<double> recorded_start_time(const Scene& scene) {
  if (!scene.start) return std::nullopt;
  const double first = scene.start->positions.front().time;
  if (!(scene.start->positions.back().time > first)) return std::nullopt;
  return first;
}

FrameClock::FrameClock(const Scene& scene, const MotionPart& part, const TrackRates& rates) {
  const std::optional<TimeSpan> motion = motion_time_span(scene);
  if (!motion && !(scene.start && part.to)) {
    throw InputError(fmt::format(
        "{}: nothing moves (allowed: [[gripper.pose]] or [[obstacle.pose]] with time and "
        "position, or trajectory = \"file.csv\", or [track] start with an end, --to)",
        scene.file));
  }
  const std::optional<double> recorded = recorded_start_time(scene);
  begin_ = part.from ? *part.from : recorded ? *recorded : motion ? motion->begin : 0;
  end_ = part.to ? *part.to : motion->end;
  if (!(end_ > begin_)) {
    const std::string poses =
        motion ? fmt::format("; poses are from {:g} s to {:g} s", motion->begin, motion->end) : "";
    throw InputError(fmt::format("{}: from {:g} s to {:g} s: no time passes (allowed: to > from{})",
                                 scene.file, begin_, end_, poses));
  }
  rate_ = rates.frame_rate;
  obstacle_rate_ = rates.obstacle_rate.value_or(rate_);
  constexpr double most_frames = 1e7;
  const double steps = std::ceil((end_ - begin_) * rate_ * (1 - 1e-12));
  if (!(steps < most_frames)) {
    throw InputError(fmt::format("{}: {:g} frames (allowed: up to {:g}, by a lower frame rate)",
                                 scene.file, steps, most_frames));
  }
  steps_ = static_cast<std::size_t>(steps);
}

double FrameClock::time(std::size_t frame) const {
  return frame >= steps_ ? end_ : begin_ + static_cast<double>(frame) / rate_;
}

double FrameClock::obstacle_time(std::size_t frame) const {
  const double elapsed = time(frame) - begin_;
  constexpr double rounding = 1e-9;
  return std::min(end_, begin_ + std::floor(elapsed * obstacle_rate_ + rounding) / obstacle_rate_);
}

Scene FrameClock::scene(const Scene& scene, std::size_t frame) const {
  return scene_at(scene, time(frame), obstacle_time(frame));
}

Scene FrameClock::scene_before(const Scene& scene, std::size_t frame, double share) const {
  return scene_at(scene, std::lerp(time(frame - 1), time(frame), share),
                  std::lerp(obstacle_time(frame - 1), obstacle_time(frame), share));
}

std::vector<std::size_t> obstacles_ever_in_reach(const Scene& scene, const FrameClock& clock) {
  std::vector<bool> reached(scene.obstacles.size(), false);
  for (std::size_t frame = 0; frame < clock.frames() && !scene.obstacles.empty(); ++frame) {
    const Scene now = clock.scene(scene, frame);
    for (const std::size_t i : obstacles_in_reach(now, now.force_model)) reached[i] = true;
  }
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) result.push_back(i);
  }
  return result;
}

energy_model::Problem frame_problem(const Scene& now, const std::vector<std::size_t>& obstacles) {
  now.require_potential("the energy model");
  energy_model::Problem problem = energy_problem(now);
  problem.obstacles.clear();
  for (const std::size_t i : obstacles) {
    problem.obstacles.push_back({now.obstacles[i].body, now.obstacles[i].stiffness});
  }
  return problem;
}

}  // namespace dlo::compare
