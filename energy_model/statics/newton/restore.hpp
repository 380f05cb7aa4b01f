#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Gap at the grips from which a descent starts, and the most that it leaves on its way.
inline constexpr double loosest_gap = 1e-5;

/// What restore() works in; buffers survive from one call to the next.
struct RestoreScratch {
  SpanPoint trial;
  Eigen::MatrixXd square, normal;
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd along, step;
};

/// Steps to |c| <= gap, each of which has to make it smaller: Levenberg and Marquardt's, which are
/// Gauss-Newton's near the end,
///     -J^T (J J^T + mu)^-1 c.
/// Where the Jacobian loses rank (a straight rod that has to become shorter) they stop short; a
/// small bend in all unknowns then leads on.
/// @param[in,out] point  evaluated
/// @param most_energy    above which nobody asks how it goes on
/// @return whether the gap is closed
[[nodiscard]] bool restore(SpanSolution& solution, SpanPoint& point, double gap,
                           RestoreScratch& scratch,
                           double most_energy = std::numeric_limits<double>::infinity());

}  // namespace dlo::energy_model
