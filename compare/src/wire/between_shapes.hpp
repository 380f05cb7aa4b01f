#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/shape.hpp"
#include "least_squares/error_correlation.hpp"

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

/// Nothing is known of a shape's frame. @param frames  its columns, the first of the design
[[nodiscard]] std::vector<Nuisance> frame_nuisances(Eigen::Index frames);

/// What each shape alone says of one number: generalised least squares of it and the shape's
/// nuisances, linear about the common fit.
/// @param series  of all shapes, whose errors have that covariance up to their variance [m^2]
/// @param column  the number's;  @param nuisances  of each shape
[[nodiscard]] std::vector<ShapeEstimate> estimates_of_shapes(
    const std::vector<ResidualSeries>& series, const ErrorCovariance& covariance, double variance,
    Eigen::Index column, const std::vector<std::vector<Nuisance>>& nuisances);

/// What of a shape's points is across its rod, in a plane that all shapes share.
struct AcrossRod {
  std::vector<double> arc_length;  ///< grows [m]
  std::vector<double> gap;         ///< of each point, to the rod's left [m]
};

/// @param normal  of the plane;  @param shape  as it lies on the rod;  @param rod  at many arc
///                lengths
[[nodiscard]] AcrossRod across_rod(const Shape& shape, const Shape& rod,
                                   const Eigen::Vector3d& normal);

/// Share of the mean square that all have in common at equal arc lengths: N |mean|^2 over the sum
/// of squares, 1 / N of independent ones, 1 of equal ones; none of fewer than two, or of those
/// that have less than half of their arc lengths in common.
[[nodiscard]] std::optional<double> common_share(const std::vector<AcrossRod>& shapes);

/// Distance of each shape from the mean of the others, as that of a rod is measured: at equal arc
/// lengths by `file`, else to the nearest point of the mean, RMS [m]; none of fewer than two, or of
/// those that have less than half of their arc lengths in common.
[[nodiscard]] std::optional<double> repeatability(const std::vector<Shape>& shapes,
                                                  ArcLengths rule);

/// Between what chance gives, 0, and all of it, 1.
[[nodiscard]] double beyond_chance(double share, std::size_t shapes);

/// Whether estimates differ by more than their variances explain (Cochran's Q, chance below 1/20),
/// and what that does to the interval of their mean; none of fewer than two that say something.
/// @param quantile  of the interval without a scatter, in standard deviations
[[nodiscard]] std::optional<ScatterBetweenShapes> scatter_between(
    const std::vector<ShapeEstimate>& estimates, double quantile);

}  // namespace dlo::compare
