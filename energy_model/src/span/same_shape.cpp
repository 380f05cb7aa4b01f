#include "span/same_shape.hpp"

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "certify/rigid_body_modes.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {

bool is_same_shape(const SpanSolution& a, const SpanSolution& b, double tolerance) {
  const Span& span = a.model->span();
  if (std::abs(a.energy - b.energy) > 1e-2 * tolerance * (1 + span.total_load())) return false;
  // Without softer parts points differ by less than strains do.
  if (a.model->size() == b.model->size() && a.terms == b.terms && span.parts.empty() &&
      span.planar == b.model->span().planar && span.cuts == b.model->span().cuts &&
      (a.x - b.x).norm() < tolerance * span.length) {
    return true;
  }
  const std::vector<double> s = {0.3 * span.length, 0.6 * span.length, span.length};
  const Eigen::Matrix3Xd of_a = a.model->shape(a.x).sample(s).points;
  const Eigen::Matrix3Xd of_b = b.model->shape(b.x).sample(s).points;
  if ((of_a - of_b).norm() < tolerance * span.length) return true;
  const bool planar = span.planar && b.model->span().planar;
  return !planar && is_turned_copy(span, of_a, of_b);
}

bool is_better(const SpanSolution& a, const SpanSolution& b) {
  const auto rank = [](const SpanSolution& solution) {
    if (succeeded(solution.status)) return 0;
    return solution.is_equilibrium() ? 1 : 2;
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a.energy < b.energy;
}

}  // namespace dlo::energy_model
