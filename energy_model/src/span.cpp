#include "span.hpp"

namespace dlo::energy_model {

double Span::total_load() const {
  double total = weight.norm() * length;
  for (const Load& load : loads) total += load.force.norm();
  return total;
}

}  // namespace dlo::energy_model
