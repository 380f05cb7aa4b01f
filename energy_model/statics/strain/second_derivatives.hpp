#pragma once

#include <Eigen/Core>

#include "linear/reduced_hessian.hpp"
#include "strain/span_energy.hpp"
#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Second derivatives of E - mu . c, and the constraints' Jacobian.
struct SecondDerivatives {
  Eigen::MatrixXd hessian, jacobian;
};

[[nodiscard]] SecondDerivatives second_derivatives(const SpanEnergy& model,
                                                   const Eigen::VectorXd& x,
                                                   const Eigen::VectorXd& multipliers);
[[nodiscard]] inline SecondDerivatives second_derivatives(const SpanSolution& solution) {
  return second_derivatives(*solution.model, solution.x, solution.multipliers);
}

/// Returns the Hessian restricted to the directions that the constraints leave free.
[[nodiscard]] inline ReducedHessian reduced_hessian(const SecondDerivatives& at) {
  ReducedHessian reduced;
  reduced.compute(at.hessian, at.jacobian);
  return reduced;
}

/// Returns the second derivatives at an equilibrium x that was found in another model of the same
/// span, which may be planar there and in space here. The multipliers mu minimise the residual of
/// the gradient. In the plane the clamps' angles of `of` are shifted to the winding of the shape.
[[nodiscard]] SecondDerivatives second_derivatives_at(SpanEnergy& of, const SpanEnergy& found_in,
                                                      const Eigen::VectorXd& x);

/// Returns the second derivatives for bending (and twisting, with material directors) of a planar
/// span out of its plane, at a point of the model. The unknowns of a round rod are the rates of the
/// tangent's tilt; with material directors they are the last unknowns of the same span in space.
[[nodiscard]] SecondDerivatives second_derivatives_out_of_plane(const SpanEnergy& model,
                                                                SpanPoint& at,
                                                                const Eigen::VectorXd& multipliers);

}  // namespace dlo::energy_model
