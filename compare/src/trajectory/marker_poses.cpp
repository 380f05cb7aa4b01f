#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "dlo/compare/error.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Largest relative error of the mean distance of two markers: larger than errors of their
/// placement, smaller than a wrong unit or a wrong pair of markers.
constexpr double distance_share = 0.2;

/// Trajectory of a marker, and its arc length on the rod [m].
struct MarkerTrajectory {
  double arc_length = 0;
  Trajectory trajectory;
};

/// Returns the trajectories of both markers, by arc length.
/// @throws InputError unless there are exactly two
std::vector<MarkerTrajectory> marker_trajectories(const MarkerMotion& markers,
                                                  std::optional<double> cutoff) {
  std::map<double, std::vector<Pose>> by_arc_length;
  for (const MarkerPosition& at : markers.positions) {
    by_arc_length[at.arc_length].push_back({at.time, at.position, std::nullopt, std::nullopt});
  }
  if (by_arc_length.size() != 2) {
    throw InputError(
        fmt::format("{}: {} marker{}, by their arc lengths s (allowed: two, on the gripper)",
                    markers.file, by_arc_length.size(), by_arc_length.size() == 1 ? "" : "s"));
  }
  std::vector<MarkerTrajectory> ways;
  ways.reserve(by_arc_length.size());
  for (auto& [s, poses] : by_arc_length) {
    if (cutoff) poses = smooth_poses(std::move(poses), *cutoff);
    ways.push_back({s, Trajectory(std::move(poses))});
  }
  return ways;
}

/// Returns the times at which both are observed, those of the trajectory with more of them.
std::vector<double> common_times(const Trajectory& a, const Trajectory& b) {
  const double begin = std::max(a.begin(), b.begin());
  const double end = std::min(a.end(), b.end());
  const auto times_of = [&](const Trajectory& trajectory) {
    std::vector<double> times;
    times.reserve(trajectory.poses().size());
    for (const Pose& pose : trajectory.poses()) {
      if (pose.time >= begin && pose.time <= end) times.push_back(pose.time);
    }
    return times;
  };
  std::vector<double> of_a = times_of(a);
  std::vector<double> of_b = times_of(b);
  return of_b.size() > of_a.size() ? of_b : of_a;
}

}  // namespace

std::vector<Pose> poses_of_markers(const MarkerMotion& markers, double at,
                                   std::optional<double> cutoff) {
  const std::vector<MarkerTrajectory> ways = marker_trajectories(markers, cutoff);
  const MarkerTrajectory& a = ways.front();
  const MarkerTrajectory& b = ways.back();
  const std::vector<double> times = common_times(a.trajectory, b.trajectory);
  if (times.empty()) {
    throw InputError(fmt::format(
        "{}: the markers at s = {:g} and {:g} m are not seen at the same time (allowed: times that "
        "overlap)",
        markers.file, a.arc_length, b.arc_length));
  }
  const double spacing = b.arc_length - a.arc_length;
  const double offset = at - (a.arc_length + b.arc_length) / 2;
  double mean = 0;
  std::vector<Pose> poses;
  poses.reserve(times.size());
  for (const double time : times) {
    const Eigen::Vector3d first = a.trajectory.pose_at(time).position;
    const Eigen::Vector3d second = b.trajectory.pose_at(time).position;
    mean += (second - first).norm() / static_cast<double>(times.size());
    const Eigen::Vector3d direction = (second - first).normalized();
    poses.push_back({time, (first + second) / 2 + offset * direction, direction, std::nullopt});
  }
  if (!(std::abs(mean - spacing) <= distance_share * spacing)) {
    throw InputError(fmt::format(
        "{}: the markers at s = {:g} and {:g} m are {:.4g} m apart on average (allowed: {:.4g} to "
        "{:.4g} m)",
        markers.file, a.arc_length, b.arc_length, mean, (1 - distance_share) * spacing,
        (1 + distance_share) * spacing));
  }
  return poses;
}

}  // namespace dlo::compare
