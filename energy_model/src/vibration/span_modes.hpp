#pragma once

#include <Eigen/Core>
#include <array>

namespace dlo::energy_model {

/// Solutions of H v = lambda M v on the free directions, by growing lambda.
struct SpanModes {
  Eigen::VectorXd lambdas;
  Eigen::MatrixXd shapes;   ///< v, by column, v^T M v = 1
  Eigen::VectorXd outside;  ///< share of the kinetic energy along the last axis [-]
};

/// @param masses    by axis of movement; M is their sum
/// @param count     of modes, fewer if there are not as many that have inertia
/// Modes of one frequency are those that move along the last axis most and least.
[[nodiscard]] SpanModes span_modes(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                                   const std::array<Eigen::MatrixXd, 3>& masses,
                                   Eigen::Index count);

}  // namespace dlo::energy_model
