#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "fit/error_correlation.hpp"

namespace dlo::compare {

/// What one shape alone says of a number.
struct ShapeEstimate {
  double value = 0;     ///< less the common estimate
  double variance = 0;  ///< infinite where it says nothing
};

/// Another number that one shape has to be freed of: a column of its design.
struct Nuisance {
  Eigen::Index column = 0;
  double value = 0;         ///< as it is now
  double known_before = 0;  ///< standard deviation about zero; infinite: nothing was known
};

/// The series of one shape.
[[nodiscard]] std::vector<ResidualSeries> series_of_shape(const std::vector<ResidualSeries>& all,
                                                          std::size_t shape);

/// Generalised least squares of one number and its nuisances, linear about the common fit.
/// @param series    of that shape;  @param column  the number's
/// @param variance  of the errors, whose covariance is known up to it
[[nodiscard]] ShapeEstimate estimate_of_shape(const std::vector<ResidualSeries>& series,
                                              const ErrorCovariance& covariance, double variance,
                                              Eigen::Index column,
                                              const std::vector<Nuisance>& nuisances);

/// Whether estimates differ by more than their variances explain (Cochran's Q, chance below 1/20),
/// and what that does to the interval of their mean; none of fewer than two that say something.
/// @param quantile  of the interval without a scatter, in standard deviations
[[nodiscard]] std::optional<ScatterBetweenShapes> scatter_between(
    const std::vector<ShapeEstimate>& estimates, double quantile);

}  // namespace dlo::compare
