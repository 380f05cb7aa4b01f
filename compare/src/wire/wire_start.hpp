#pragma once

#include <Eigen/Core>

#include "least_squares/fitted_rods.hpp"
#include "least_squares/material_point.hpp"
#include "wire/wire_problem.hpp"

namespace dlo::compare {

/// Returns values of a wire's numbers from which the iteration converges to the fit.
/// @param material     material that fits best without the other numbers
/// @param[in,out] rods  rods with all numbers; set to the equilibria nearest to the shapes there
[[nodiscard]] Eigen::VectorXd wire_start(const WireProblem& problem, const MaterialPoint& material,
                                         FittedRods& rods);

}  // namespace dlo::compare
