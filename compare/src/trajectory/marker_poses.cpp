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
struct MarkerWay {
  double arc_length = 0;
  Trajectory way;
};

/// Returns the trajectories of all markers, by arc length.
std::vector<MarkerWay> ways_of(const MarkerMotion& markers, std::optional<double> cutoff) {
  std::map<double, std::vector<Pose>> seen;
  for (const MarkerPosition& at : markers.positions) {
    seen[at.arc_length].push_back({at.time, at.position, std::nullopt, std::nullopt});
  }
  if (seen.size() != 2) {
    throw InputError(
        fmt::format("{}: {} marker{}, by their arc lengths s (allowed: two, on the gripper)",
                    markers.file, seen.size(), seen.size() == 1 ? "" : "s"));
  }
  std::vector<MarkerWay> ways;
  ways.reserve(seen.size());
  for (auto& [s, poses] : seen) {
    if (cutoff) poses = smooth_poses(std::move(poses), *cutoff);
    ways.push_back({s, Trajectory(std::move(poses))});
  }
  return ways;
}

/// Returns the times at which both are observed, those of the trajectory with more of them.
std::vector<double> common_times(const Trajectory& a, const Trajectory& b) {
  const double begin = std::max(a.begin(), b.begin());
  const double end = std::min(a.end(), b.end());
  const auto times_of = [&](const Trajectory& way) {
    std::vector<double> times;
    times.reserve(way.poses().size());
    for (const Pose& pose : way.poses()) {
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
  const std::vector<MarkerWay> ways = ways_of(markers, cutoff);
  const MarkerWay& a = ways.front();
  const MarkerWay& b = ways.back();
  const std::vector<double> times = common_times(a.way, b.way);
  if (times.empty()) {
    throw InputError(fmt::format(
        "{}: the markers at s = {:g} and {:g} m are not seen at the same time (allowed: times that "
        "overlap)",
        markers.file, a.arc_length, b.arc_length));
  }
  const double apart = b.arc_length - a.arc_length;
  const double ahead = at - (a.arc_length + b.arc_length) / 2;
  double mean = 0;
  std::vector<Pose> poses;
  poses.reserve(times.size());
  for (const double time : times) {
    const Eigen::Vector3d first = a.way.pose_at(time).position;
    const Eigen::Vector3d second = b.way.pose_at(time).position;
    mean += (second - first).norm() / static_cast<double>(times.size());
    const Eigen::Vector3d direction = (second - first).normalized();
    poses.push_back({time, (first + second) / 2 + ahead * direction, direction, std::nullopt});
  }
  if (!(std::abs(mean - apart) <= distance_share * apart)) {
    throw InputError(fmt::format(
        "{}: the markers at s = {:g} and {:g} m are {:.4g} m apart on average (allowed: {:.4g} to "
        "{:.4g} m)",
        markers.file, a.arc_length, b.arc_length, mean, (1 - distance_share) * apart,
        (1 + distance_share) * apart));
  }
  return poses;
}

}  // namespace dlo::compare
