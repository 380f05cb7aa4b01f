#include "recording/lag_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "polygon/scalar_search.hpp"
#include "recording/motion_residuals.hpp"

namespace dlo::compare {
namespace {

/// Lags that are looked at before Brent's method, and points that they are looked at with: of a
/// recording of 1e6 points all would take a minute.
constexpr int lag_steps = 200;
constexpr std::size_t most_looked_at = 20'000;

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
  const std::size_t stride = 1 + recorded.positions.size() / most_looked_at;
  for (std::size_t i = 0; i < recorded.positions.size(); i += stride) {
    if (recorded.positions[i].time - range < earliest) continue;
    usable.positions.push_back(recorded.positions[i]);
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
