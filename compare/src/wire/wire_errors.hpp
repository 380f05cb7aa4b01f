#pragma once

#include <Eigen/Core>
#include <optional>

#include "least_squares/error_correlation.hpp"
#include "least_squares/gauss_newton.hpp"

namespace dlo::compare {

/// Errors of the points about the rods of a least squares fit.
struct WireErrors {
  bool tested = false;          ///< whether they are correlated; else there are too few, or none
  ErrorCovariance correlation;  ///< independent, unless they are shown not to be
  double variance = 0;          ///< of a coordinate; given, or from the residuals [m^2]
  double freedom = 0;           ///< degrees, of the residuals
  /// Sum of squares of the residuals over what the variance explains, and of how many degrees of
  /// freedom it then is: of correlated errors by Satterthwaite, since residuals tell their length
  /// of correlation hardly better than their variance.
  double squares = 0;
  double freedom_of_squares = 0;

  [[nodiscard]] bool are_correlated() const { return correlation.share > 0; }
};

/// @param frames       columns of the design before those of the numbers
/// @param noise        standard deviation of a coordinate, if it is known [m]
/// @param least_noise  below it residuals are the solver's [m]
[[nodiscard]] WireErrors errors_about(const GaussNewton& fit, Eigen::Index frames,
                                      const std::optional<double>& noise, double least_noise);

/// The variance over which squares of these errors count as much as they tell of the first number
/// [m^2]: correlated errors tell less than as many independent ones.
[[nodiscard]] double weight_of(const WireErrors& errors, const GaussNewton& fit);

/// Covariance of the fitted numbers. That of correlated errors is known from the residuals only:
/// the mean over all that they leave likely.
[[nodiscard]] Eigen::MatrixXd covariance_of_numbers(const WireErrors& errors,
                                                    const GaussNewton& fit, Eigen::Index frames,
                                                    const std::optional<double>& noise);

}  // namespace dlo::compare
