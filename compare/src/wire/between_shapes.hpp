#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/shape.hpp"
#include "least_squares/error_correlation.hpp"

namespace dlo::compare {

/// Estimate of a number from one shape alone.
struct ShapeEstimate {
  double value = 0;     ///< relative to the common estimate
  double variance = 0;  ///< infinite if the shape does not determine the number
};

/// Another number that is eliminated from the estimate of one shape: a column of its design.
struct Nuisance {
  Eigen::Index column = 0;
  double value = 0;            ///< current value
  double prior_deviation = 0;  ///< prior standard deviation about zero; infinite: no prior
};

/// Returns the estimate of the first number from each shape alone: generalised least squares of the
/// number, the frames and the shape's nuisances, linearised about the common fit.
/// @param series  of all shapes; their errors have this covariance up to the variance [m^2]
/// @param frames  number of columns of frames, before that of the number
/// @param nuisances  of each shape
[[nodiscard]] std::vector<ShapeEstimate> estimates_of_shapes(
    const std::vector<ResidualSeries>& series, const ErrorCovariance& covariance, double variance,
    Eigen::Index frames, const std::vector<std::vector<Nuisance>>& nuisances);

/// Distances of a shape's points across its rod, in a plane that all shapes share.
struct CrossDistances {
  std::vector<double> arc_length;  ///< non-decreasing [m]
  std::vector<double> gap;         ///< distance of each point to the rod's left [m]
};

/// Computes the distances across the rod.
/// @param normal  of the plane
/// @param shape  aligned with the rod
/// @param rod  sampled at many arc lengths
[[nodiscard]] CrossDistances cross_distances(const Shape& shape, const Shape& rod,
                                             const Eigen::Vector3d& normal);

/// Returns the share of the mean square that all shapes have in common at equal arc lengths: N
/// |mean|^2 divided by the sum of squares. It is 1 / N for independent shapes and 1 for equal ones.
/// Returns std::nullopt for fewer than two shapes, if less than half of the longest is common to
/// all, or if all distances are 0.
[[nodiscard]] std::optional<double> common_share(const std::vector<CrossDistances>& shapes);

/// Returns the RMS, over all shapes, of the distance of a shape from the mean of the others [m],
/// measured as the distance from a rod: at equal arc lengths with `file`, else to the nearest point
/// of the mean. Returns std::nullopt for fewer than two shapes, or if less than half of the longest
/// is common to all.
[[nodiscard]] std::optional<double> repeatability(const std::vector<Shape>& shapes,
                                                  ArcLengths rule);

/// Rescales common_share(), so that 0 is the value expected by chance and 1 that of equal shapes.
[[nodiscard]] double share_beyond_chance(double share, std::size_t shapes);

/// Tests whether estimates differ by more than their variances explain (Cochran's Q, probability
/// below 1/20), and returns the effect on the interval of their mean. Returns std::nullopt if they
/// do not, or if fewer than two shapes determine the number.
/// @param quantile  half width of the interval without scatter, in standard deviations
[[nodiscard]] std::optional<ScatterBetweenShapes> scatter_between(
    const std::vector<ShapeEstimate>& estimates, double quantile);

}  // namespace dlo::compare
