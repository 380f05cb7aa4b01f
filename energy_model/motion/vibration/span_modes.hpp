#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Solutions of H v = lambda M v on the free directions, by growing lambda.
struct SpanModes {
  Eigen::VectorXd lambdas;
  Eigen::MatrixXd shapes;   ///< v, by column, v^T M v = 1
  Eigen::VectorXd outside;  ///< share of the kinetic energy of the movement outside [-]
};

/// @param mass     M
/// @param outside  of it, that of the movement along an axis
/// @param count    of modes, fewer if there are not as many that have inertia
/// Modes of one frequency are those that move outside most and least.
[[nodiscard]] SpanModes span_modes(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                                   const Eigen::MatrixXd& mass, const Eigen::MatrixXd& outside,
                                   Eigen::Index count);

}  // namespace dlo::energy_model
