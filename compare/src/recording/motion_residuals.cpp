#include "recording/motion_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace dlo::compare {
namespace {

/// Sums over the points of one group.
struct Sum {
  double squares = 0;
  double largest = 0;
  double largest_at = 0;
  double count = 0;

  void add(double distance, double at) {
    squares += distance * distance;
    count += 1;
    if (!(distance > largest)) return;
    largest = distance;
    largest_at = at;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
};

}  // namespace

Eigen::Matrix3Xd motion_residuals(const MarkerMotion& recorded, const ModelMotion& model,
                                  double lag) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(recorded.positions.size()));
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    const MarkerPosition& point = recorded.positions[static_cast<std::size_t>(i)];
    result.col(i) = point.position - model.at(point.time - lag, point.arc_length);
  }
  return result;
}

double rms_of(const Eigen::Matrix3Xd& residuals) {
  return std::sqrt(residuals.squaredNorm() / static_cast<double>(residuals.cols()));
}

MotionErrors motion_errors(const MarkerMotion& recorded, const Eigen::Matrix3Xd& residuals,
                           double length, std::size_t listed) {
  MotionErrors result;
  std::map<double, Sum> by_time;
  std::map<double, Sum> by_marker;
  std::map<int, Sum> by_third;
  for (std::size_t i = 0; i < recorded.positions.size(); ++i) {
    const MarkerPosition& point = recorded.positions[i];
    const double distance = residuals.col(static_cast<Eigen::Index>(i)).norm();
    by_time[point.time].add(distance, point.arc_length);
    const int third = std::clamp(static_cast<int>(3 * point.arc_length / length), 0, 2);
    by_third[third].add(distance, point.arc_length);
    if (by_marker.size() <= listed) by_marker[point.arc_length].add(distance, 0);
  }
  result.rms_m = rms_of(residuals);
  for (const auto& [time, sum] : by_time) {
    result.frames.push_back({time, sum.rms(), sum.largest, sum.largest_at});
    result.largest_m = std::max(result.largest_m, sum.largest);
  }
  const auto worst = std::ranges::max_element(result.frames, {}, &FrameError::rms_m);
  result.worst_frame = static_cast<std::size_t>(worst - result.frames.begin());
  for (const auto& [third, sum] : by_third) {
    result.thirds.push_back({third * length / 3, (third + 1) * length / 3, sum.rms(), sum.largest});
  }
  if (by_marker.size() > listed) return result;
  for (const auto& [s, sum] : by_marker) {
    result.markers.push_back({s, s, sum.rms(), sum.largest});
  }
  return result;
}

}  // namespace dlo::compare
