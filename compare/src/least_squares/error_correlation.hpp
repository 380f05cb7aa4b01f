#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dlo::compare {

/// One coordinate of a shape's residuals, by growing arc length, and how the fitted numbers move
/// it.
struct ResidualSeries {
  std::size_t shape = 0;           ///< whose they are
  std::vector<double> arc_length;  ///< grows [m], n
  Eigen::VectorXd residual;        ///< [m], n
  Eigen::MatrixXd design;          ///< its derivatives by the fitted numbers, n x p, any scale
};

/// Errors e along the rod whose covariance is, up to a factor,
///     C(s, s') = (1 - share) [s = s'] + share exp(-|s - s'| / length):
/// white noise of the points plus a first-order autoregression in arc length.
struct ErrorCovariance {
  double share = 0;   ///< of the variance that is correlated, 0 to 1
  double length = 0;  ///< of correlation [m]
};

/// Returns an orthonormal basis of the span of design columns, which may have any scale. A column
/// that the others explain up to the errors of derivatives by differences counts as explained: two
/// numbers that move all points alike have one column in the basis.
[[nodiscard]] Eigen::MatrixXd basis_of(Eigen::MatrixXd columns);

/// With no more than 250 rows each, equally many left out between two: enough to tell covariances
/// apart, of which hundreds are tried.
[[nodiscard]] std::vector<ResidualSeries> thinned(const std::vector<ResidualSeries>& series);

/// What residuals say of the errors' correlation, see correlation_of().
struct CorrelationEstimate {
  ErrorCovariance covariance;  ///< the most likely one
  /// Twice the gain in (restricted) log likelihood over independent errors.
  double likelihood_gain = 0;
  bool tested = false;       ///< there were enough residuals
  bool significant = false;  ///< independent errors gain as much in less than one case of twenty
};

/// The most likely covariance by restricted maximum likelihood, which allows for what the fitted
/// numbers took out of the residuals; of thinned() series. The likelihood is that of a Kalman
/// filter's innovations, so it costs O(n p) for n residuals.
[[nodiscard]] CorrelationEstimate correlation_of(const std::vector<ResidualSeries>& series);

/// A covariance and how likely it is beside others.
struct LikelyCovariance {
  ErrorCovariance covariance;
  double weight = 0;  ///< all weights sum up to 1
};

/// All covariances of a grid that residuals leave likely, a thousandth as much as the most likely
/// one at least, by the restricted likelihood. Where there are too few residuals: independence.
[[nodiscard]] std::vector<LikelyCovariance> likely_covariances(
    const std::vector<ResidualSeries>& series);

/// What a covariance does to a least squares fit that takes errors for independent.
struct CorrelationEffect {
  /// Variance of a fitted number over that of independent errors with the same variance.
  double variance_factor = 1;
  /// Expected sum of squares of the residuals over that of independent errors with the same
  /// variance; below 1, for the fitted numbers take out what neighbours have in common.
  double residual_factor = 1;
  /// Of the sum of squares (Satterthwaite: the chi-squared distribution of the same mean and
  /// variance).
  double degrees_of_freedom = 0;
};

/// Residuals and their design, all series below each other, turned into innovations: errors of this
/// covariance become independent, of the same variance each.
struct Innovations {
  Eigen::VectorXd residual;  ///< n
  Eigen::MatrixXd design;    ///< n x p
};

/// Without correlation they are the residuals themselves.
[[nodiscard]] Innovations innovations(const std::vector<ResidualSeries>& series,
                                      const ErrorCovariance& covariance);

/// columns' C columns.
/// @param columns  a row for each residual, the series below each other
[[nodiscard]] Eigen::MatrixXd covariance_products(const std::vector<ResidualSeries>& series,
                                                  const Eigen::MatrixXd& columns,
                                                  const ErrorCovariance& covariance);

/// @param column  of the design: the fitted number
[[nodiscard]] CorrelationEffect correlation_effect(const std::vector<ResidualSeries>& series,
                                                   Eigen::Index column,
                                                   const ErrorCovariance& covariance);

}  // namespace dlo::compare
