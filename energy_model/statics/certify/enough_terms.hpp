#pragma once

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Returns the number of coefficients of each element that resolve a rod under this load to about
/// 1e-10 of its length. The load acts on an element of length h as h^2 of it would act on a rod of
/// length 1. A softer rod has elements of their own for the layers at its clamps.
[[nodiscard]] int first_terms(double load, double longest_piece);

/// Returns how many coefficients of a shape are needed so that the dropped ones contribute at most
/// `tolerance`. The last of K coefficients contributes an angle of a_K / (2K), and its effect on
/// positions is smaller by this factor again.
/// @param least  number of coefficients kept in any case, if there are as many
[[nodiscard]] int terms_needed(const SpanEnergy& model, const Eigen::VectorXd& x, double tolerance,
                               int least);

/// Returns the number of coefficients that resolve the buckling modes of a twisted span, helices
/// with a rate of half its torque, even if its own shape is simple.
[[nodiscard]] int terms_under_twist(const SpanSolution& solution);

}  // namespace dlo::energy_model
