#include "span/negative_curvature.hpp"

#include "linear/free_directions.hpp"
#include "strain/point_on_span.hpp"

namespace dlo::energy_model {

std::optional<NegativeCurvature> negative_curvature(const SpanSolution& solution) {
  SpanEnergy& model = *solution.model;
  SecondDerivatives at = second_derivatives(solution);
  ReducedHessian reduced;
  reduced.compute(at.hessian, at.jacobian);
  if (std::optional<Eigen::VectorXd> within = negative_curvature_direction(reduced)) {
    return NegativeCurvature{model.span(), std::move(*within)};
  }
  if (!model.span().planar) return std::nullopt;
  model.sideways(solution.multipliers, at.hessian, at.jacobian);
  reduced.compute(at.hessian, at.jacobian);
  const std::optional<Eigen::VectorXd> out_of_plane = negative_curvature_direction(reduced);
  if (!out_of_plane) return std::nullopt;
  NegativeCurvature out{model.span(), Eigen::VectorXd::Zero(model.size() + out_of_plane->size())};
  out.span.planar = false;
  // Out of the plane a planar rod bends by u2, the rate of its tangent's tilt, and twists.
  out.direction.tail(out_of_plane->size()) = *out_of_plane;
  return out;
}

}  // namespace dlo::energy_model
