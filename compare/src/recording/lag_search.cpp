#include "recording/lag_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "polygon/scalar_search.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

/// Number of lags that are scanned before Brent's method, and largest number of points used for the
/// scan. With all 1e6 points of a recording it would take a minute.
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

MotionShift shift_of(const Eigen::Matrix3Xd& residuals, double lag, Displacement displacement) {
  MotionShift result{.lag = lag};
  if (displacement == Displacement::constant) result.offset = residuals.rowwise().mean();
  result.rms_m = rms_of(residuals.colwise() - result.offset);
  return result;
}

}  // namespace

MotionShift best_offset(const MarkerMotion& recorded, const ModelMotion& model) {
  return shift_of(motion_residuals(recorded, model), 0, Displacement::constant);
}

std::optional<MotionShift> best_lag(const MarkerMotion& recorded, const ModelMotion& model,
                                    double earliest, Displacement displacement) {
  const double last = recorded.positions.back().time;
  const double range = lag_range_share * (last - recorded.positions.front().time);
  MarkerMotion usable{.file = recorded.file, .positions = {}};
  for (const MarkerPosition& at : thinned(recorded.positions)) {
    if (at.time - range >= earliest) usable.positions.push_back(at);
  }
  constexpr std::size_t fewest = 8;
  const double low = std::max(-range, last - model.end());
  if (usable.positions.size() < fewest || !(range > 0) || !(low < 0)) return std::nullopt;
  const Function left = [&](double lag) {
    return shift_of(motion_residuals(usable, model, lag), lag, displacement).rms_m;
  };
  const Scan seen = scan(left, low, range, lag_steps);
  if (!seen.is_bracketed()) return std::nullopt;
  const double lag = minimum_near(left, seen, 1e-6 * range).x;
  return shift_of(motion_residuals(usable, model, lag), lag, displacement);
}

}  // namespace dlo::compare
