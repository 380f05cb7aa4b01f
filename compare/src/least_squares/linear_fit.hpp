#pragma once

#include <Eigen/Core>
#include <vector>

#include "least_squares/error_correlation.hpp"

namespace dlo::compare {

/// Generalised least squares, linearised about some values of the fitted numbers, some of which
/// have priors. All matrices are in the order of the numbers.
struct LinearFit {
  Eigen::MatrixXd design;    ///< innovations by the numbers, minus the part that frames explain
  Eigen::VectorXd residual;  ///< innovations of points minus rod, with the frames' part removed
  Eigen::Index freedom = 0;  ///< number of rows minus rank of the frames' columns
};

/// Linearises a fit.
/// @param frames  number of columns of the series' design, before those of the numbers, that belong
/// to frames
[[nodiscard]] LinearFit linear_fit(const std::vector<ResidualSeries>& series,
                                   const ErrorCovariance& covariance, Eigen::Index frames);

/// Returns the covariance of the numbers after the fit. For numbers that are unseen() it is that of
/// the pseudoinverse, which is no variance.
/// @param variance  of the errors
/// @param before  1 over the prior standard deviation of each number about zero
[[nodiscard]] Eigen::MatrixXd posterior(const LinearFit& fit, double variance,
                                        const Eigen::VectorXd& before);

/// Returns the covariance of the numbers after a least squares fit that assumes independent errors,
/// for errors with another covariance.
/// @param series  of the fit;  @param weight  variance by which its squares were divided
/// @param errors  covariance of the errors, up to `variance`
[[nodiscard]] Eigen::MatrixXd posterior_under(const std::vector<ResidualSeries>& series,
                                              const LinearFit& fit, double weight,
                                              const Eigen::VectorXd& before,
                                              const ErrorCovariance& errors, double variance);

/// Variance of errors of a given correlation, estimated from the residuals of generalised least
/// squares without priors, and its degrees of freedom.
struct VarianceEstimate {
  double variance = 0;  ///< [m^2]
  double freedom = 0;
};
[[nodiscard]] VarianceEstimate variance_under(const std::vector<ResidualSeries>& series,
                                              const ErrorCovariance& errors, Eigen::Index frames);

/// Returns for each number whether neither the points nor priors determine it, alone or in
/// combination with others. The variance of such a number is infinite.
[[nodiscard]] std::vector<bool> unseen(const LinearFit& fit, double variance,
                                       const Eigen::VectorXd& before);

/// Returns minus half the derivative of the deviance by the numbers. The deviance is the sum of
/// squares divided by the variance, plus the priors' terms.
[[nodiscard]] Eigen::VectorXd slope(const LinearFit& fit, double variance,
                                    const Eigen::VectorXd& before, const Eigen::VectorXd& values);

/// Returns the logarithm of the determinant of half the deviance's second derivatives by all
/// numbers except the first, without those that neither points nor priors determine.
[[nodiscard]] double log_determinant(const LinearFit& fit, double variance,
                                     const Eigen::VectorXd& before);

/// Returns the step of all numbers except the first to the least deviance, if the first one moves
/// by `held`.
/// @param slope  result of slope(), of all numbers
[[nodiscard]] Eigen::VectorXd step_of_others(const LinearFit& fit, double variance,
                                             const Eigen::VectorXd& before,
                                             const Eigen::VectorXd& slope, double held);

}  // namespace dlo::compare
