#include "wire/between_shapes.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/gsl.hpp"

namespace dlo::compare {
namespace {

/// Part of a number's column, relative to the column, that must remain after its nuisances are
/// removed; a smaller part is rounding.
constexpr double least_column_remainder = 1e-7;
/// Probability below which estimates are reported to scatter.
constexpr double significance_level = 0.05;

/// Weighted mean of estimates with weights 1 / (variance + between): its precision, and the
/// weighted sum of squared distances from it.
struct WeightedScatter {
  double sum_of_squares = 0;
  double precision = 0;  // inverse variance of the mean
};

WeightedScatter weighted_scatter(const std::vector<ShapeEstimate>& estimates, double between) {
  double mean = 0;
  WeightedScatter result;
  for (const ShapeEstimate& one : estimates) {
    const double weight = 1 / (one.variance + between);
    result.precision += weight;
    mean += weight * one.value;
  }
  mean /= result.precision;
  for (const ShapeEstimate& one : estimates) {
    result.sum_of_squares += std::pow(one.value - mean, 2) / (one.variance + between);
  }
  return result;
}

/// Returns the variance between estimates for which the weighted sum of squares has its expected
/// value (Paule and Mandel 1982). The sum decreases with the variance.
double variance_between(const std::vector<ShapeEstimate>& estimates, double expected) {
  double low = 0;
  double high = 1;
  while (weighted_scatter(estimates, high).sum_of_squares > expected) high *= 4;
  constexpr int bisections = 60;
  for (int i = 0; i < bisections; ++i) {
    const double middle = (low + high) / 2;
    (weighted_scatter(estimates, middle).sum_of_squares > expected ? low : high) = middle;
  }
  return high;
}

/// Estimates one number from one shape. @param variance  of the innovations [m^2]
ShapeEstimate estimate_of_shape(const Innovations& whitened, double variance, Eigen::Index column,
                                const std::vector<Nuisance>& nuisances) {
  const Eigen::Index rows = whitened.residual.size();
  const auto count = static_cast<Eigen::Index>(nuisances.size());
  // Each prior adds a row, in units of the errors.
  Eigen::MatrixXd others = Eigen::MatrixXd::Zero(rows + count, count);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(rows + count);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows + count);
  own.head(rows) = whitened.design.col(column);
  residual.head(rows) = whitened.residual;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Nuisance& nuisance = nuisances[static_cast<std::size_t>(k)];
    const double weight = std::sqrt(variance) / nuisance.prior_deviation;
    others.col(k).head(rows) = whitened.design.col(nuisance.column);
    others(rows + k, k) = weight;
    residual[rows + k] = -weight * nuisance.value;
  }
  const double whole = own.norm();
  if (count > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(others);
    const Eigen::MatrixXd basis =
        qr.householderQ() * Eigen::MatrixXd::Identity(rows + count, qr.rank());
    own -= basis * (basis.transpose() * own).eval();
  }
  if (!(own.norm() > least_column_remainder * whole)) return {0, INFINITY};
  return {own.dot(residual) / own.squaredNorm(), variance / own.squaredNorm()};
}

/// Returns the squared distance of a point from a polyline [m^2].
double squared_distance(const Eigen::Vector3d& point, const Eigen::Matrix3Xd& nodes) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k + 1 < nodes.cols(); ++k) {
    const Eigen::Vector3d segment = nodes.col(k + 1) - nodes.col(k);
    const Eigen::Vector3d gap = point - nodes.col(k);
    const double share = std::clamp(gap.dot(segment) / segment.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (gap - share * segment).squaredNorm());
  }
  return least;
}

/// Number of positions along the rod at which shapes are compared.
constexpr int places = 21;

/// Returns arc lengths equally spaced over the range common to all shapes; std::nullopt for fewer
/// than two shapes, or if the range is less than half of the longest shape.
template <typename Of>
std::optional<std::vector<double>> common_arc_lengths(const std::vector<Of>& shapes) {
  if (shapes.size() < 2) return std::nullopt;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  double longest = 0;
  for (const Of& shape : shapes) {
    const std::vector<double>& s = shape.arc_length;
    if (s.size() < 2) return std::nullopt;
    low = std::max(low, s.front());
    high = std::min(high, s.back());
    longest = std::max(longest, s.back() - s.front());
  }
  if (!(high - low > longest / 2)) return std::nullopt;
  std::vector<double> result;
  result.reserve(places);
  for (int k = 0; k < places; ++k) result.push_back(low + (high - low) * k / (places - 1));
  return result;
}

}  // namespace

CrossDistances cross_distances(const Shape& shape, const Shape& rod,
                               const Eigen::Vector3d& normal) {
  CrossDistances result;
  const std::vector<double>& s = rod.arc_length;
  for (Eigen::Index i = 0; i < shape.points.cols(); ++i) {
    const double at = shape.arc_length[static_cast<std::size_t>(i)];
    const auto above = std::upper_bound(s.begin() + 1, s.end() - 1, at);
    const Eigen::Index k = above - s.begin();
    const Eigen::Vector3d begin = rod.points.col(k - 1);
    const Eigen::Vector3d along = (rod.points.col(k) - begin).normalized();
    result.arc_length.push_back(at);
    // Distances across the rod treat the segment as straight; the position along it does not
    // matter.
    result.gap.push_back(normal.cross(along).dot(shape.points.col(i) - begin));
  }
  return result;
}

std::optional<double> common_share(const std::vector<CrossDistances>& shapes) {
  const std::optional<std::vector<double>> at = common_arc_lengths(shapes);
  if (!at) return std::nullopt;
  std::vector<std::vector<double>> gaps;
  gaps.reserve(shapes.size());
  for (const CrossDistances& one : shapes) {
    gaps.push_back(interpolated(one.gap, one.arc_length, *at));
  }
  double common = 0;
  double all = 0;
  for (std::size_t k = 0; k < at->size(); ++k) {
    double sum = 0;
    for (const std::vector<double>& gap : gaps) {
      sum += gap[k];
      all += gap[k] * gap[k];
    }
    common += sum * sum / static_cast<double>(shapes.size());
  }
  if (!(all > 0)) return std::nullopt;
  return common / all;
}

std::optional<double> repeatability(const std::vector<Shape>& shapes, ArcLengths rule) {
  const std::optional<std::vector<double>> at = common_arc_lengths(shapes);
  if (!at) return std::nullopt;
  std::vector<Eigen::Matrix3Xd> at_places;
  at_places.reserve(shapes.size());
  Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, places);
  for (const Shape& shape : shapes) {
    at_places.push_back(resample(shape, *at).points);
    sum += at_places.back();
  }
  const auto count = static_cast<double>(shapes.size());
  double sum_of_squares = 0;
  for (const Eigen::Matrix3Xd& points : at_places) {
    const Eigen::Matrix3Xd others = (sum - points) / (count - 1);
    for (int k = 0; k < places; ++k) {
      sum_of_squares += rule == ArcLengths::file ? (points.col(k) - others.col(k)).squaredNorm()
                                                 : squared_distance(points.col(k), others);
    }
  }
  return std::sqrt(sum_of_squares / (places * count));
}

double share_beyond_chance(double share, std::size_t shapes) {
  const double expected_share = 1 / static_cast<double>(shapes);
  return (share - expected_share) / (1 - expected_share);
}

std::vector<ShapeEstimate> estimates_of_shapes(
    const std::vector<ResidualSeries>& series, const ErrorCovariance& covariance, double variance,
    Eigen::Index frames, const std::vector<std::vector<Nuisance>>& nuisances) {
  std::vector<Nuisance> of_frames;
  for (Eigen::Index k = 0; k < frames; ++k) of_frames.push_back({k, 0, INFINITY});
  std::vector<ShapeEstimate> result;
  result.reserve(nuisances.size());
  for (std::size_t shape = 0; shape < nuisances.size(); ++shape) {
    std::vector<ResidualSeries> own;
    std::copy_if(series.begin(), series.end(), std::back_inserter(own),
                 [shape](const ResidualSeries& one) { return one.shape == shape; });
    std::vector<Nuisance> all = of_frames;
    all.insert(all.end(), nuisances[shape].begin(), nuisances[shape].end());
    result.push_back(estimate_of_shape(innovations(own, covariance), variance, frames, all));
  }
  return result;
}

std::optional<ScatterBetweenShapes> scatter_between(const std::vector<ShapeEstimate>& estimates,
                                                    double quantile) {
  std::vector<ShapeEstimate> informative;
  std::copy_if(estimates.begin(), estimates.end(), std::back_inserter(informative),
               [](const ShapeEstimate& one) { return std::isfinite(one.variance); });
  if (informative.size() < 2) return std::nullopt;
  const auto freedom = static_cast<double>(informative.size() - 1);
  const WeightedScatter together = weighted_scatter(informative, 0);
  const double chance = gsl_distribution(gsl_cdf_chisq_Q, together.sum_of_squares, freedom);
  if (!(chance < significance_level)) return std::nullopt;
  const double between = variance_between(informative, freedom);
  const double with = gsl_distribution(gsl_cdf_tdist_Pinv, 0.975, freedom) /
                      std::sqrt(weighted_scatter(informative, between).precision);
  const double without = quantile / std::sqrt(together.precision);
  return ScatterBetweenShapes{.relative_deviation = std::sqrt(between),
                              .chance = chance,
                              .widening = std::max(1.0, with / without)};
}

}  // namespace dlo::compare
