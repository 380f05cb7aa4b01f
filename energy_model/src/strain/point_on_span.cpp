#include "strain/point_on_span.hpp"

#include <utility>

namespace dlo::energy_model {

void evaluate(SpanEnergy& model, PointOnSpan& point) {
  point.gradient.resize(model.size());
  point.residual.resize(model.constraints());
  point.jacobian.resize(model.constraints(), model.size());
  point.energy = model.value(point.x, point.gradient);
  model.constraint(point.residual, point.jacobian);
}

void evaluate(SpanSolution& solution, PointOnSpan& point) {
  evaluate(*solution.model, point);
  ++solution.evaluations;
}

PointOnSpan evaluated(SpanEnergy& model, const Eigen::VectorXd& x) {
  PointOnSpan point;
  point.x = x;
  evaluate(model, point);
  return point;
}

SecondDerivatives second_derivatives(SpanEnergy& model, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& multipliers) {
  SecondDerivatives result;
  result.jacobian = std::move(evaluated(model, x).jacobian);
  model.hessian(multipliers, result.hessian);
  return result;
}

}  // namespace dlo::energy_model
