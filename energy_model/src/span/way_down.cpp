#include "span/way_down.hpp"

#include "linear/free_directions.hpp"

namespace dlo::energy_model {

std::optional<WayDown> way_down(const SpanSolution& solution) {
  SpanEnergy& model = *solution.model;
  Eigen::VectorXd gradient(model.size());
  (void)model.value(solution.x, gradient);
  Eigen::MatrixXd hessian;
  Eigen::MatrixXd jacobian(model.constraints(), model.size());
  Eigen::VectorXd residual(model.constraints());
  model.constraint(residual, jacobian);
  model.hessian(solution.multipliers, hessian);
  if (std::optional<Eigen::VectorXd> within = falling_direction(hessian, jacobian)) {
    return WayDown{model.span(), std::move(*within)};
  }
  if (!model.span().planar) return std::nullopt;
  model.sideways(solution.multipliers, hessian, jacobian);
  const std::optional<Eigen::VectorXd> sideways = falling_direction(hessian, jacobian);
  if (!sideways) return std::nullopt;
  WayDown out{model.span(), Eigen::VectorXd::Zero(model.size() + sideways->size())};
  out.span.planar = false;
  // Out of the plane a planar rod bends by u2, the rate of its tangent's tilt, and twists.
  out.along.tail(sideways->size()) = *sideways;
  return out;
}

}  // namespace dlo::energy_model
