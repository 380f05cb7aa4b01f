#include "problem/span.hpp"

#include <Eigen/Geometry>
#include <algorithm>

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
  return sum;
}

double Span::total_load() const {
  double total = weight.norm() * length;
  for (const Part& part : parts) {
    total += ((weight + part.weight).norm() - weight.norm()) * (part.end - part.begin);
  }
  for (const Load& load : loads) total += load.force.norm();
  return total;
}

Eigen::Vector3d Span::force_before(double s) const {
  Eigen::Vector3d force = weight_between(0, s);
  for (const Load& load : loads) {
    if (load.at < s) force += load.force;
  }
  return force;
}

bool Span::pulled_one_way() const {
  Eigen::Vector3d sum = weight_between(0, length);
  for (const Load& load : loads) sum += load.force;
  constexpr double rounding = 1e-12;
  return sum.norm() >= (1 - rounding) * total_load();
}

}  // namespace dlo::energy_model
