#include "wire/identifiable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/gsl.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {

bool has_forces_beside_weight(const Scene& scene) {
  const bool loaded = scene.total_load_magnitude() > 0;
  const std::vector<std::size_t> in_reach = obstacles_in_reach(scene);
  return loaded || std::any_of(in_reach.begin(), in_reach.end(), [&](std::size_t i) {
           return std::isfinite(scene.obstacles[i].stiffness);
         });
}

bool has_external_force(const Scene& scene) {
  return scene.weight_per_length().norm() > 0 || has_forces_beside_weight(scene);
}

std::string why_stiffness_not_identifiable(const Scene& scene) {
  return fmt::format(
      "{0} is not identifiable from these shapes: neither weight nor a load or yielding obstacle "
      "acts on the rod, so its shapes are the same with any {0} (a known load would identify it)",
      scene.stiffness().name);
}

double interval_quantile(const std::optional<double>& noise, double freedom) {
  constexpr double one_side = 0.975;
  return noise ? gsl_distribution(gsl_cdf_ugaussian_Pinv, one_side)
               : gsl_distribution(gsl_cdf_tdist_Pinv, one_side, freedom);
}

FittedValue fitted_value(double logarithm, const LogProfile::Interval& interval, double unit,
                         double largest_interval_ratio) {
  FittedValue result{.estimate = unit * std::exp(logarithm)};
  if (interval.low) result.low = unit * std::exp(*interval.low);
  if (interval.high) result.high = unit * std::exp(*interval.high);
  const bool closed = result.low && result.high;
  if (closed && *result.high <= largest_interval_ratio * *result.low)
    result.value = result.estimate;
  return result;
}

bool include_interval(FittedValue& value, const FittedValue& other, double largest_interval_ratio) {
  const bool low = value.low && other.low;
  const bool high = value.high && other.high;
  value.low = low ? std::optional(std::min(*value.low, *other.low)) : std::nullopt;
  value.high = high ? std::optional(std::max(*value.high, *other.high)) : std::nullopt;
  const bool is_identified = low && high && *value.high <= largest_interval_ratio * *value.low;
  if (!is_identified) value.value.reset();
  return is_identified;
}

}  // namespace dlo::compare
