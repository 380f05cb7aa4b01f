#pragma once

#include <Eigen/Core>
#include <optional>

#include "least_squares/error_correlation.hpp"
#include "least_squares/gauss_newton.hpp"

namespace dlo::compare {

/// Errors of the points about the rods of a least squares fit.
struct WireErrors {
  bool tested = false;  ///< whether correlation was tested; false with too few residuals or none
  ErrorCovariance correlation;  ///< independent, unless correlation is significant
  double variance = 0;          ///< variance of a coordinate; given, or from the residuals [m^2]
  double freedom = 0;           ///< degrees of freedom of the residuals
  /// Sum of squares of the residuals divided by the variance, and its degrees of freedom. For
  /// correlated errors these are Satterthwaite's, since residuals determine the correlation length
  /// hardly better than their variance.
  double squares = 0;
  double freedom_of_squares = 0;

  [[nodiscard]] bool are_correlated() const { return correlation.share > 0; }
};

/// Estimates the errors about a fit.
/// @param frames  number of columns of the design before those of the numbers
/// @param noise        standard deviation of a coordinate, if known [m]
/// @param least_noise  residuals below it are errors of the solver [m]
[[nodiscard]] WireErrors errors_about(const GaussNewton& fit, Eigen::Index frames,
                                      const std::optional<double>& noise, double least_noise);

/// Returns the variance by which squares are divided so that they have the information about the
/// first number that these errors leave [m^2]: correlated errors carry less information than as
/// many independent ones.
[[nodiscard]] double weight_of(const WireErrors& errors, const GaussNewton& fit);

/// Returns the covariance of the fitted numbers. The covariance of correlated errors is only known
/// from the residuals, so the result is the mean over all likely ones.
[[nodiscard]] Eigen::MatrixXd covariance_of_numbers(const WireErrors& errors,
                                                    const GaussNewton& fit, Eigen::Index frames,
                                                    const std::optional<double>& noise);

}  // namespace dlo::compare
