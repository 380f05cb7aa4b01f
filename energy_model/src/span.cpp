#include "span.hpp"

namespace dlo::energy_model {

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
