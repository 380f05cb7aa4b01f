#include "recording/motion_residuals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "polygon/scalar_search.hpp"

namespace dlo::compare {
namespace {

/// Lagrange's weights of four neighbours among values at 0, 1, .. count - 1.
struct LagrangeWeights {
  Eigen::Index first = 0;
  std::array<double, 4> weights{};
};

LagrangeWeights neighbours(double at, Eigen::Index count) {
  const auto last = static_cast<double>(count - 1);
  const double x = std::clamp(at, 0.0, last);
  LagrangeWeights result;
  result.first =
      std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(x)) - 1, 0, count - 4);
  const double t = x - static_cast<double>(result.first);
  result.weights = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
                    -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6};
  return result;
}

/// Number of lags that are scanned before Brent's method, and approximate largest number of points
/// used for both. With all 1e6 points of a recording it would take a minute.
constexpr int lag_steps = 200;
constexpr std::size_t most_tried_points = 20'000;

/// Returns the positions at every n-th time of a recording, with all markers of that time.
std::vector<MarkerPosition> thinned(const std::vector<MarkerPosition>& positions) {
  const std::size_t stride = 1 + positions.size() / most_tried_points;
  std::vector<MarkerPosition> result;
  std::size_t time = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (i > 0 && positions[i].time > positions[i - 1].time) ++time;
    if (time % stride == 0) result.push_back(positions[i]);
  }
  return result;
}

MotionShift make_shift(const Eigen::Matrix3Xd& residuals, double lag, Displacement displacement) {
  MotionShift result{.lag = lag};
  if (displacement == Displacement::constant) result.offset = residuals.rowwise().mean();
  result.rms_m = rms_of(residuals.colwise() - result.offset);
  return result;
}

/// Sums over the points of one group.
struct Sum {
  double sum_of_squares = 0;
  double largest = 0;
  double largest_at = 0;
  double count = 0;

  void add(double distance, double at) {
    sum_of_squares += distance * distance;
    count += 1;
    if (!(distance > largest)) return;
    largest = distance;
    largest_at = at;
  }
  [[nodiscard]] double rms() const { return std::sqrt(sum_of_squares / count); }
};

}  // namespace

ModelMotion::ModelMotion(double begin, double end, double length,
                         std::vector<Eigen::Matrix3Xd> frames)
    : begin_(begin), end_(end), length_(length), frames_(std::move(frames)) {}

Eigen::Vector3d ModelMotion::at(double time, double arc_length) const {
  const auto count = static_cast<Eigen::Index>(frames_.size());
  const Eigen::Index points = frames_.front().cols();
  const LagrangeWeights in_time =
      neighbours((time - begin_) / (end_ - begin_) * static_cast<double>(count - 1), count);
  const LagrangeWeights along =
      neighbours(arc_length / length_ * static_cast<double>(points - 1), points);
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Matrix3Xd& frame = frames_[static_cast<std::size_t>(in_time.first + i)];
    for (Eigen::Index k = 0; k < 4; ++k) {
      result += in_time.weights[static_cast<std::size_t>(i)] *
                along.weights[static_cast<std::size_t>(k)] * frame.col(along.first + k);
    }
  }
  return result;
}

RecordedTimes recorded_times(const MarkerMotion& recorded, double length) {
  RecordedTimes times{.first = recorded.positions.front().time};
  double before = -std::numeric_limits<double>::infinity();
  for (const MarkerPosition& at : recorded.positions) {
    if (!on_rod(at.arc_length, length)) {
      throw InputError(fmt::format("{}: a point at s = {:g} m (allowed: 0 to the rod's {:g} m)",
                                   recorded.file, at.arc_length, length));
    }
    times.count += at.time > before ? 1 : 0;
    before = at.time;
  }
  times.last = before;
  return times;
}

std::string lag_words(const MotionShift& shift) {
  return fmt::format("it is {:.4g} ms {}", std::abs(shift.lag) * 1e3,
                     shift.lag > 0 ? "late" : "early");
}

MotionShift best_offset(const MarkerMotion& recorded, const ModelMotion& model) {
  return make_shift(motion_residuals(recorded, model), 0, Displacement::constant);
}

std::optional<MotionShift> best_lag(const MarkerMotion& recorded, const ModelMotion& model,
                                    double earliest, Displacement displacement) {
  const double last = recorded.positions.back().time;
  const double range = lag_range_share * (last - recorded.positions.front().time);
  MarkerMotion usable{.file = recorded.file, .positions = {}};
  for (const MarkerPosition& at : thinned(recorded.positions)) {
    if (at.time - range >= earliest) usable.positions.push_back(at);
  }
  constexpr std::size_t least_count = 8;
  const double low = std::max(-range, last - model.end());
  if (usable.positions.size() < least_count || !(range > 0) || !(low < 0)) return std::nullopt;
  const Function residual = [&](double lag) {
    return make_shift(motion_residuals(usable, model, lag), lag, displacement).rms_m;
  };
  const Scan scanned = scan(residual, low, range, lag_steps);
  if (!scanned.is_bracketed()) return std::nullopt;
  const double lag = minimum_near(residual, scanned, 1e-6 * range).x;
  MotionShift best = make_shift(motion_residuals(usable, model, lag), lag, displacement);
  best.unshifted_rms_m = rms_of(motion_residuals(usable, model));
  return best;
}

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
