#pragma once

#include <Eigen/Core>

#include "least_squares/fitted_rods.hpp"
#include "least_squares/material_point.hpp"
#include "wire/wire_problem.hpp"

namespace dlo::compare {

/// Values of a wire's numbers from which steps lead to the fit.
/// @param material     that fits best without the other numbers
/// @param[in,out] rods  of all numbers; they go on from the equilibria that are nearest there
[[nodiscard]] Eigen::VectorXd wire_start(const WireProblem& problem, const MaterialPoint& material,
                                         FittedRods& rods);

}  // namespace dlo::compare
