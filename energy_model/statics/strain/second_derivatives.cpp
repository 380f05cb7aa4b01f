#include "strain/second_derivatives.hpp"

#include <Eigen/QR>
#include <utility>
#include <vector>

namespace dlo::energy_model {

SecondDerivatives second_derivatives(const SpanEnergy& model, const Eigen::VectorXd& x,
                                     const Eigen::VectorXd& multipliers) {
  SpanPoint point = model.evaluated(x);
  SecondDerivatives result;
  model.hessian(point, multipliers, result.hessian);
  result.jacobian = std::move(point.jacobian);
  return result;
}

SecondDerivatives second_derivatives_at(SpanEnergy& of, const SpanEnergy& found_in,
                                        const Eigen::VectorXd& x) {
  SpanPoint point = of.evaluated(of.prolong(found_in, x));
  // The forces are the same; these multipliers express them in the constraints of `of`.
  const Eigen::VectorXd multipliers =
      of.constraints() == 0
          ? Eigen::VectorXd()
          : Eigen::VectorXd(
                point.jacobian.transpose().completeOrthogonalDecomposition().solve(point.gradient));
  SecondDerivatives result;
  of.hessian(point, multipliers, result.hessian);
  result.jacobian = std::move(point.jacobian);
  return result;
}

SecondDerivatives second_derivatives_out_of_plane(const SpanEnergy& model, SpanPoint& at,
                                                  const Eigen::VectorXd& multipliers) {
  SecondDerivatives result;
  if (!model.span().has_material_directors()) {
    model.tilt_hessian(at, multipliers, result.hessian, result.jacobian);
    return result;
  }
  // A rod that is intrinsically curved, or has another stiffness out of its plane, twists when it
  // leaves it.
  Span space = model.span();
  space.planar = false;
  SpanEnergy twin(space, model.terms());
  const SecondDerivatives all = second_derivatives_at(twin, model, at.x);
  const Eigen::Index out = twin.size() - model.size();
  result.hessian = all.hessian.bottomRightCorner(out, out);
  // Rows that act out of the plane: the z component of a position, and the component of a direction
  // along z.
  std::vector<Eigen::Index> rows;
  const Eigen::Index holds = std::ssize(space.holds);
  for (Eigen::Index j = 0; j < holds; ++j) rows.push_back(3 * j + 2);
  for (Eigen::Index row = twin.first_direction_row(); row < twin.constraints(); row += 2) {
    rows.push_back(row);
  }
  result.jacobian = all.jacobian(rows, Eigen::lastN(out));
  return result;
}

}  // namespace dlo::energy_model
