#include "motion/force_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/point_layout.hpp"
#include "solve/polygon_solution.hpp"

namespace dlo::compare {
namespace {

/// Returns the polygon's points on the energy model's shape, except those that grips hold.
Eigen::Matrix3Xd points_on_shape(const Discretisation& discretisation,
                                 const energy_model::Equilibrium& rod) {
  std::vector<double> s = discretisation.arc_length;
  for (double& at : s) at = std::clamp(at, 0.0, discretisation.length);
  Eigen::Matrix3Xd points = rod.sample(s).points;
  for (const force_model::Grip& grip : discretisation.rod.grips) {
    points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  return points;
}

}  // namespace

ForceTrack::ForceTrack(const Scene& now, const energy_model::Equilibrium& rod,
                       const std::vector<std::size_t>& obstacles, const SolveOptions& options)
    : obstacles_(obstacles), settings_(now.force_model) {
  if (plane_transform(now, now.force_model)) {
    throw InputError(fmt::format(
        "{}: the polygon of an intrinsically curved rod moves only in the plane z = 0", now.file));
  }
  discretisation_ = discretise(now, now.force_model);
  set_obstacles(now, obstacles, discretisation_);
  try {
    simulation_.emplace(discretisation_.rod, points_on_shape(discretisation_, rod),
                        step_options(now.force_model, discretisation_));
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: the force model: {}", now.file, error.what()));
  }
  const force_model::RelaxResult result = simulation_->relax({.tolerance = options.rest_tolerance,
                                                              .max_steps = options.max_steps,
                                                              .time_limit = options.time_limit});
  if (result.status == force_model::RelaxStatus::at_rest) return;
  throw ConvergenceError(fmt::format(
      "{}: the force model did not come to rest before the motion: {}", now.file, result.message));
}

bool ForceTrack::step(const Scene& now, long steps) {
  Discretisation moved = discretise(now, settings_);
  set_obstacles(now, obstacles_, moved);
  force_model::Simulation& simulation = *simulation_;
  const Timer timer;
  for (std::size_t i = 0; i < moved.rod.grips.size(); ++i) {
    simulation.move_grip(i, moved.rod.grips[i].targets, moved.rod.grips[i].reference);
  }
  for (std::size_t i = 0; i < moved.rod.walls.size(); ++i) {
    const force_model::Wall& wall = moved.rod.walls[i];
    const force_model::Wall& last = simulation.rod().walls[i];
    if (wall.point != last.point) simulation.move_wall(i, wall);
  }
  bool finite = true;
  for (long i = 0; i < steps && finite; ++i) {
    finite = simulation.step().status != force_model::StepStatus::diverged;
  }
  seconds_ = timer.seconds();
  discretisation_ = std::move(moved);
  return finite;
}

ForceFrame ForceTrack::frame(const energy_model::Equilibrium& rod,
                             const std::vector<double>& arc_length) const {
  const force_model::Simulation& simulation = *simulation_;
  const Eigen::Matrix3Xd points = simulation.points();
  ForceFrame frame;
  frame.shape = discretisation_.shape(points);
  frame.error_over_length = distance(frame.shape, rod.sample) / discretisation_.length;
  frame.points = resample(frame.shape, arc_length).points;
  frame.grippers = gripper_loads(simulation.rod(), points);
  return frame;
}

void ForceErrors::finish(const std::vector<Eigen::Matrix3Xd>& leader,
                         const std::vector<Eigen::Matrix3Xd>& follower, double step,
                         double length) {
  mean /= static_cast<double>(leader.size());
  const Lag found = estimate_lag(leader, follower, step);
  lag = found.time;
  error_without_lag = found.rms / length;
}

Lag estimate_lag(const std::vector<Eigen::Matrix3Xd>& leader,
                 const std::vector<Eigen::Matrix3Xd>& follower, double step) {
  constexpr std::size_t most_lag_samples = 400;
  const std::size_t count = leader.size();
  double moved = 0;
  for (const Eigen::Matrix3Xd& shape : leader) {
    moved = std::max(moved, (shape - leader.front()).squaredNorm());
  }
  const double rounding = 1e-9 * (leader.front().colwise() - leader.front().col(0)).norm();
  if (!(moved > rounding * rounding)) return {};
  const std::size_t stride = std::max<std::size_t>(1, count / most_lag_samples);
  const auto squares_at = [&](std::size_t shift) {
    double sum = 0;
    for (std::size_t i = 0; i < count; i += stride) {
      sum += (follower[i] - leader[i > shift ? i - shift : 0]).squaredNorm();
    }
    return sum;
  };
  std::vector<double> squares;
  for (std::size_t shift = 0; shift < count; ++shift) squares.push_back(squares_at(shift));
  const auto best =
      static_cast<std::size_t>(std::min_element(squares.begin(), squares.end()) - squares.begin());
  // The best match is the leader at its first shape throughout: no lag can be determined.
  if (best + 1 == count) return {};
  double part = 0;
  double least = squares[best];
  // Minimum of the parabola through three values; at zero shift its mirror image replaces the value
  // on the other side.
  const double before = best > 0 ? squares[best - 1] : squares[best + 1];
  const double after = squares[best + 1];
  const double bend = before - 2 * least + after;
  if (bend > 0) {
    part = (before - after) / (2 * bend);
    least = std::max(0.0, least - (before - after) * part / 4);
  }
  const double samples = std::ceil(static_cast<double>(count) / static_cast<double>(stride));
  return {(static_cast<double>(best) + part) * step,
          std::sqrt(least / (samples * static_cast<double>(leader.front().cols())))};
}

}  // namespace dlo::compare
