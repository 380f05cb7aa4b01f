#include "certify/enough_terms.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

int first_terms(double load, double longest_piece) {
  const double own_load = load * longest_piece * longest_piece;
  return static_cast<int>(std::ceil(9 * std::pow(std::clamp(own_load, 0.7, 1000.0), 0.24)));
}

int terms_needed(const SpanEnergy& model, const Eigen::VectorXd& x, double tolerance, int least) {
  int terms = model.terms();
  while (terms > least) {
    const double K = terms - 1;
    if (!(model.truncation(x, terms - 1) < tolerance * 4 * K * K)) break;
    --terms;
  }
  return terms;
}

int terms_under_twist(const SpanSolution& solution) {
  const SpanEnergy& model = *solution.model;
  const double torque = model.twisting_torque(solution.x, solution.multipliers);
  return first_terms(torque * torque, model.longest_piece());
}

}  // namespace dlo::energy_model
