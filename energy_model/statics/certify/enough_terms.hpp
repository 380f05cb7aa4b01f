#pragma once

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Coefficients of each piece that resolve a rod under this load (which a piece of length h feels
/// as a rod of length 1 feels h^2 of it) to about 1e-10 of its length. A softer rod has the layers
/// at its clamps in pieces of their own.
[[nodiscard]] int first_terms(double load, double longest_piece);

/// Of the coefficients of a shape, those that add more to its angle than this: the angle that the
/// last of K adds is a_K / (2K), and positions feel it as little again.
/// @param least  that are kept in any case, if there are as many
[[nodiscard]] int terms_needed(const SpanEnergy& model, const Eigen::VectorXd& x, double tolerance,
                               int least);

/// Coefficients that resolve the ways in which a twisted span gives way, helices of a rate of half
/// its torque, however simple its own shape is.
[[nodiscard]] int terms_under_twist(const SpanSolution& solution);

}  // namespace dlo::energy_model
