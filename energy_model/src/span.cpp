#include "span.hpp"

#include <Eigen/Geometry>

namespace dlo::energy_model {

Eigen::Vector3d Span::d1(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return direction.cross(z).norm() > 1e-3 ? z : direction.unitOrthogonal();
}

double Span::total_load() const {
  double total = weight.norm() * length;
  for (const Load& load : loads) total += load.force.norm();
  return total;
}

Eigen::Vector3d Span::force_before(double s) const {
  Eigen::Vector3d force = s * weight;
  for (const Load& load : loads) {
    if (load.at < s) force += load.force;
  }
  return force;
}

bool Span::pulled_one_way() const {
  Eigen::Vector3d sum = weight * length;
  for (const Load& load : loads) sum += load.force;
  constexpr double rounding = 1e-12;
  return sum.norm() >= (1 - rounding) * total_load();
}

}  // namespace dlo::energy_model
