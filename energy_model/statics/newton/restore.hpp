#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>

#include "strain/span_solution.hpp"

namespace dlo::energy_model {

/// Constraint residual from which a descent starts, and the largest one that it leaves between
/// steps.
inline constexpr double loosest_gap = 1e-5;

/// Buffers of restore(), kept from one call to the next.
struct RestoreScratch {
  SpanPoint trial;
  Eigen::MatrixXd square, normal;
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::VectorXd along, step;
};

/// Reduces the constraint residual to |c| <= gap by steps that each have to decrease it:
/// Levenberg-Marquardt steps, which become Gauss-Newton steps near the end,
///     -J^T (J J^T + mu)^-1 c.
/// @param[in,out] point  evaluated
/// @param most_energy    energy above which the search is abandoned
/// @return whether the residual was reduced to `gap`
[[nodiscard]] bool restore(SpanSolution& solution, SpanPoint& point, double gap,
                           RestoreScratch& scratch,
                           double most_energy = std::numeric_limits<double>::infinity());

}  // namespace dlo::energy_model
