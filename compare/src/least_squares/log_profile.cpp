#include "least_squares/log_profile.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace dlo::compare {
namespace {

constexpr int profile_steps_per_decade = 4;
const double profile_step = std::log(10.0) / profile_steps_per_decade;
/// Ratio of a sum of squares to the least one above which it is outside any interval of interest
/// (Student's t beyond 97.5 % with 2 degrees of freedom: 1 + 4.3^2 / 2 = 10). Between steps of a
/// quarter of a decade, a local minimum above it cannot be the least one.
constexpr double irrelevant_ratio = 100;

}  // namespace

std::vector<double> drawn_logarithms(const std::optional<double>& low, double best,
                                     const std::optional<double>& high, int count) {
  const double from = low.value_or(best - std::log(2.0));
  const double to = high.value_or(best + std::log(2.0));
  const double beyond = (to - from) / 2;
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(std::max(0, count)));
  for (int i = 0; i < count; ++i) {
    result.push_back(from - beyond + (to - from + 2 * beyond) * i / std::max(1, count - 1));
  }
  return result;
}

LogProfile::LogProfile(Function function, double low, double high)
    : function_(std::move(function)),
      first_(static_cast<int>(std::floor(low / profile_step))),
      last_(static_cast<int>(std::ceil(high / profile_step))) {
  left_ = right_ = std::clamp(0, first_, last_);
  search();
  refine();
}

double LogProfile::value_at(int step) {
  const double x = profile_step * step;
  const auto known = values_.find(x);
  if (known != values_.end()) return known->second;
  const double value = function_(x);
  values_[x] = value;
  if (values_.size() == 1 || value < minimum_.value) minimum_ = {x, value};
  return value;
}

bool LogProfile::has_risen(int side) const {
  const int end = side < 0 ? left_ : right_;
  const auto value = [&](int step) {
    const auto found = values_.find(profile_step * step);
    return found == values_.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
  };
  if (!(value(end) > irrelevant_ratio * minimum_.value)) return false;
  for (int k = 0; k < profile_steps_per_decade; ++k) {
    // Plateaus count as rising: beyond them a soft rod hangs and a stiff one is straight.
    if (!(value(end - side * k) >= 0.9 * value(end - side * (k + 1)))) return false;
  }
  return true;
}

void LogProfile::search() {
  double at_left = value_at(left_);
  double at_right = at_left;
  while (true) {
    const bool to_left = left_ > first_ && !has_risen(-1);
    const bool to_right = right_ < last_ && !has_risen(1);
    if (!to_left && !to_right) return;
    if (to_left && (!to_right || at_left <= at_right)) {
      at_left = value_at(--left_);
    } else {
      at_right = value_at(++right_);
    }
  }
}

void LogProfile::refine() {
  const std::map<double, double> steps = values_;
  if (steps.size() < 3) return;
  for (auto at = std::next(steps.begin()); std::next(at) != steps.end(); ++at) {
    const auto before = std::prev(at);
    const auto after = std::next(at);
    const bool lowest = at->second <= before->second && at->second <= after->second;
    if (!lowest || !(at->second <= irrelevant_ratio * minimum_.value)) continue;
    const Scan around{{before->first, at->first, after->first},
                      {before->second, at->second, after->second}};
    const Minimum found = minimum_near(function_, around);
    values_[found.x] = found.value;
    if (found.value < minimum_.value) minimum_ = found;
  }
}

std::optional<double> LogProfile::outermost_crossing(double level, int side) {
  const auto end = [&] { return side < 0 ? *values_.begin() : *std::prev(values_.end()); };
  // The level may be higher than the values that the search reached.
  while (!(end().second > level && std::isfinite(end().second)) &&
         (side < 0 ? left_ > first_ : right_ < last_)) {
    (void)value_at(side < 0 ? --left_ : ++right_);
  }
  std::vector<std::pair<double, double>> inwards(values_.begin(), values_.end());
  if (side > 0) std::reverse(inwards.begin(), inwards.end());
  std::optional<double> outside;
  for (const auto& [x, value] : inwards) {
    if (!std::isfinite(value)) continue;
    if (value > level) {
      outside = x;
      continue;
    }
    if (!outside) return std::nullopt;
    const Function known = [&](double at) {
      const double there = function_(at);
      return std::isfinite(there) ? there : 0.0;
    };
    return find_crossing(known, x, *outside, level);
  }
  return std::nullopt;
}

LogProfile::Interval LogProfile::below(double level) {
  Interval result;
  result.low = outermost_crossing(level, -1);
  result.high = outermost_crossing(level, 1);
  return result;
}

std::vector<Minimum> LogProfile::minima_below(double level) const {
  std::vector<Minimum> result;
  for (auto at = values_.begin(); at != values_.end(); ++at) {
    const bool left = at == values_.begin() || std::prev(at)->second > at->second;
    const bool right = std::next(at) == values_.end() || std::next(at)->second >= at->second;
    if (left && right && at->second <= level) result.push_back({at->first, at->second});
  }
  return result;
}

}  // namespace dlo::compare
