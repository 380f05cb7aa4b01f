#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dlo::compare {

/// One coordinate of a shape's residuals, points minus rod, by growing arc length, and its design.
struct ResidualSeries {
  std::size_t shape = 0;           ///< index of the shape
  std::vector<double> arc_length;  ///< non-decreasing [m], n
  Eigen::VectorXd residual;        ///< [m], n
  /// Derivatives of the points by the coordinates of frames, then of the rod by the fitted numbers
  /// (minus those of the residual), n x p, any scale
  Eigen::MatrixXd design;
};

/// Covariance of errors e along the rod, up to a factor,
///     C(s, s') = (1 - share) [s = s'] + share exp(-|s - s'| / length):
/// white noise of the points plus a first-order autoregression in arc length.
struct ErrorCovariance {
  double share = 0;   ///< part of the variance that is correlated, 0 to 1
  double length = 0;  ///< correlation length [m]
};

/// Returns an orthonormal basis of the span of design columns, which may have any scale. A column
/// that the others explain up to the errors of derivatives by differences counts as explained: two
/// numbers that move all points alike have one column in the basis.
[[nodiscard]] Eigen::MatrixXd basis_of(Eigen::MatrixXd columns);

/// Correlation of the errors as estimated from residuals; see correlation_of().
struct CorrelationEstimate {
  ErrorCovariance covariance;  ///< the most likely covariance
  bool tested = false;         ///< whether there were enough residuals
  bool significant = false;    ///< independent errors gain as much in less than one case of twenty
};

/// Returns the most likely covariance of at most 250 residuals of each series by restricted maximum
/// likelihood, which accounts for the part of the errors that the fitted numbers absorbed. The
/// likelihood is that of a Kalman filter's innovations, so its cost is proportional to the number
/// of residuals.
[[nodiscard]] CorrelationEstimate correlation_of(const std::vector<ResidualSeries>& series);

/// A covariance and its probability relative to others.
struct LikelyCovariance {
  ErrorCovariance covariance;
  double weight = 0;  ///< the weights of all covariances add up to 1
};

/// Returns the covariances of a grid whose restricted likelihood is at least a thousandth of the
/// largest one. With too few residuals it returns independent errors.
[[nodiscard]] std::vector<LikelyCovariance> likely_covariances(
    const std::vector<ResidualSeries>& series);

/// Effect of a covariance on a least squares fit that assumes independent errors.
struct CorrelationEffect {
  /// Variance of a fitted number, divided by that with independent errors of the same variance.
  double variance_factor = 1;
  /// Expected sum of squares of the residuals, divided by that with independent errors of the same
  /// variance: 1 without correlation, else usually below 1, because the fitted numbers absorb what
  /// neighbours have in common.
  double residual_factor = 1;
  /// Degrees of freedom of the sum of squares: those of the chi-squared distribution with the same
  /// mean and variance (Satterthwaite).
  double degrees_of_freedom = 0;
};

/// Residuals and design of all series, concatenated and transformed into innovations: errors of the
/// covariance become independent, with equal variances.
struct Innovations {
  Eigen::VectorXd residual;  ///< n
  Eigen::MatrixXd design;    ///< n x p
};

/// Returns the innovations; without correlation these are the residuals themselves.
[[nodiscard]] Innovations innovations(const std::vector<ResidualSeries>& series,
                                      const ErrorCovariance& covariance);

/// Returns columns' C columns, with the covariance C.
/// @param columns  one row per residual, the series concatenated
[[nodiscard]] Eigen::MatrixXd covariance_products(const std::vector<ResidualSeries>& series,
                                                  const Eigen::MatrixXd& columns,
                                                  const ErrorCovariance& covariance);

/// Returns the effect of a covariance on one fitted number.
/// @param column  index of the number in the design
[[nodiscard]] CorrelationEffect correlation_effect(const std::vector<ResidualSeries>& series,
                                                   Eigen::Index column,
                                                   const ErrorCovariance& covariance);

}  // namespace dlo::compare
