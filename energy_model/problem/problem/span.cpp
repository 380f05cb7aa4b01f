#include "problem/span.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

Eigen::Vector3d Span::d1(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return direction.cross(z).norm() > 1e-3 ? z : direction.unitOrthogonal();
}

Eigen::Vector3d Span::weight_between(double from, double to) const {
  Eigen::Vector3d sum = (to - from) * weight;
  for (const Part& part : parts) {
    sum += (std::clamp(to, part.begin, part.end) - std::clamp(from, part.begin, part.end)) *
           part.weight;
  }
  for (const LineLoad& load : line_loads) sum += load.force_between(from, to);
  return sum;
}

Eigen::Vector3d Span::mean_weight() const {
  Eigen::Vector3d mean = weight;
  for (const LineLoad& load : line_loads) mean += load.force_between(0, length) / length;
  return mean;
}

double Span::total_load() const {
  double total = weight.norm() * length;
  for (const Part& part : parts) {
    total += ((weight + part.weight).norm() - weight.norm()) * (part.end - part.begin);
  }
  for (const Load& load : loads) total += load.force.norm() + std::abs(load.couple) / length;
  for (const LineLoad& load : line_loads) {
    total += (load.at_begin.norm() + load.at_end.norm()) / 2 * (load.end - load.begin);
  }
  return total;
}

Eigen::Vector3d Span::force_before(double s) const {
  Eigen::Vector3d force = weight_between(0, s);
  for (const Load& load : loads) {
    if (load.at < s) force += load.force;
  }
  return force;
}

bool Span::has_couples() const {
  return std::ranges::any_of(loads, [](const Load& load) { return load.couple != 0; });
}

bool Span::has_unidirectional_load() const {
  Eigen::Vector3d sum = weight_between(0, length);
  for (const Load& load : loads) sum += load.force;
  constexpr double rounding = 1e-12;
  return sum.norm() >= (1 - rounding) * total_load();
}

HeldBy Span::held_within(double begin, double end, double margin) const {
  const auto within = [&](double at) { return at > begin - margin && at < end + margin; };
  HeldBy support = HeldBy::nothing;
  if (within(anchor)) support = start_direction ? HeldBy::clamp : HeldBy::pin;
  for (std::size_t i = 0; i < holds.size(); ++i) {
    if (!within(holds[i].at)) continue;
    const bool clamp = holds[i].direction || (end_direction && i + 1 == holds.size());
    support = std::max(support, clamp ? HeldBy::clamp : HeldBy::pin);
  }
  return support;
}

}  // namespace dlo::energy_model
