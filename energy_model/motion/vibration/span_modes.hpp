#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Solutions of H v = lambda M v on the free directions, by ascending lambda.
struct SpanModes {
  Eigen::VectorXd lambdas;
  Eigen::MatrixXd shapes;   ///< v, by column, v^T M v = 1
  Eigen::VectorXd outside;  ///< fraction of the kinetic energy in the movement `outside` [-]
};

/// Computes the modes of a span. Modes of equal frequency are chosen so that their movement
/// `outside` is largest and smallest.
/// @param mass     M
/// @param outside  mass matrix of the movement along one axis
/// @param count    number of modes; fewer are returned if fewer have inertia
[[nodiscard]] SpanModes span_modes(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                                   const Eigen::MatrixXd& mass, const Eigen::MatrixXd& outside,
                                   Eigen::Index count);

}  // namespace dlo::energy_model
