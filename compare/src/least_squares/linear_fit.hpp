#pragma once

#include <Eigen/Core>
#include <vector>

#include "least_squares/error_correlation.hpp"

namespace dlo::compare {

/// Generalised least squares about some values of the numbers that are fitted, of some of which
/// something was known before. All matrices are in the numbers' order.
struct LinearFit {
  Eigen::MatrixXd design;  ///< innovations by the numbers, freed of what the shapes' frames explain
  Eigen::VectorXd residual;  ///< the same of the points less the rod
  Eigen::Index freedom = 0;  ///< rows less the frames' rank
};

/// @param frames  columns of the series' design that are the frames', before those of the numbers
[[nodiscard]] LinearFit linear_fit(const std::vector<ResidualSeries>& series,
                                   const ErrorCovariance& covariance, Eigen::Index frames);

/// Covariance of the numbers after the fit; of those that are unseen() the least that fits, which
/// is no variance.
/// @param variance  of the errors;  @param before  1 over what was known of each, standard
///                  deviations about zero
[[nodiscard]] Eigen::MatrixXd posterior(const LinearFit& fit, double variance,
                                        const Eigen::VectorXd& before);

/// The same of a least squares fit that takes errors for independent while they are not.
/// @param series  of which the fit is;  @param weight  the variance over which its squares counted
/// @param errors  their covariance, up to `variance`
[[nodiscard]] Eigen::MatrixXd posterior_under(const std::vector<ResidualSeries>& series,
                                              const LinearFit& fit, double weight,
                                              const Eigen::VectorXd& before,
                                              const ErrorCovariance& errors, double variance);

/// Variance of errors of that covariance, from what generalised least squares without anything
/// known before leaves, and of how many degrees of freedom that is.
struct VarianceEstimate {
  double variance = 0;  ///< [m^2]
  double freedom = 0;
};
[[nodiscard]] VarianceEstimate variance_under(const std::vector<ResidualSeries>& series,
                                              const ErrorCovariance& errors, Eigen::Index frames);

/// Of each number: neither the points nor what was known before tells it, alone or beside the
/// others. Its variance is infinite.
[[nodiscard]] std::vector<bool> unseen(const LinearFit& fit, double variance,
                                       const Eigen::VectorXd& before);

/// Minus half the derivative of the deviance (sum of squares over the variance, and of what was
/// known before) by the numbers.
[[nodiscard]] Eigen::VectorXd slope(const LinearFit& fit, double variance,
                                    const Eigen::VectorXd& before, const Eigen::VectorXd& values);

/// Logarithm of the determinant of half the deviance's second derivatives by all numbers but the
/// first, of those that the points or what was known before tell.
[[nodiscard]] double log_determinant(const LinearFit& fit, double variance,
                                     const Eigen::VectorXd& before);

/// Step of all numbers but the first to the least deviance, with the first moved by `held`.
/// @param slope  as above, of all
[[nodiscard]] Eigen::VectorXd step_of_others(const LinearFit& fit, double variance,
                                             const Eigen::VectorXd& before,
                                             const Eigen::VectorXd& slope, double held);

}  // namespace dlo::compare
