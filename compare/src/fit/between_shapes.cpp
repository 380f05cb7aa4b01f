#include "fit/between_shapes.hpp"

#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace dlo::compare {
namespace {

/// What a number's column may lose to its nuisances before it is rounding.
constexpr double least_own_share = 1e-7;
/// The chance below which estimates are said to scatter.
constexpr double significant_chance = 0.05;

/// Their mean with weights 1 / (variance + between), and how far they are from it in these weights.
struct Spread {
  double squares = 0;
  double precision = 0;  // of the mean
};

Spread spread(const std::vector<ShapeEstimate>& estimates, double between) {
  double mean = 0;
  Spread result;
  for (const ShapeEstimate& one : estimates) {
    const double weight = 1 / (one.variance + between);
    result.precision += weight;
    mean += weight * one.value;
  }
  mean /= result.precision;
  for (const ShapeEstimate& one : estimates) {
    result.squares += std::pow(one.value - mean, 2) / (one.variance + between);
  }
  return result;
}

/// The variance between estimates with which they are as far apart as they should be (Paule and
/// Mandel 1982): the squares fall as it grows.
double variance_between(const std::vector<ShapeEstimate>& estimates, double expected) {
  double low = 0;
  double high = 1;
  while (spread(estimates, high).squares > expected) high *= 4;
  constexpr int bisections = 60;
  for (int i = 0; i < bisections; ++i) {
    const double middle = (low + high) / 2;
    (spread(estimates, middle).squares > expected ? low : high) = middle;
  }
  return high;
}

}  // namespace

std::vector<ResidualSeries> series_of_shape(const std::vector<ResidualSeries>& all,
                                            std::size_t shape) {
  std::vector<ResidualSeries> own;
  std::copy_if(all.begin(), all.end(), std::back_inserter(own),
               [shape](const ResidualSeries& one) { return one.shape == shape; });
  return own;
}

ShapeEstimate estimate_of_shape(const std::vector<ResidualSeries>& series,
                                const ErrorCovariance& covariance, double variance,
                                Eigen::Index column, const std::vector<Nuisance>& nuisances) {
  const Innovations seen = innovations(series, covariance);
  const Eigen::Index rows = seen.residual.size();
  const auto count = static_cast<Eigen::Index>(nuisances.size());
  // What was known before is a row more each, in units of the errors.
  Eigen::MatrixXd others = Eigen::MatrixXd::Zero(rows + count, count);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(rows + count);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(rows + count);
  own.head(rows) = seen.design.col(column);
  residual.head(rows) = seen.residual;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Nuisance& nuisance = nuisances[static_cast<std::size_t>(k)];
    const double weight = std::sqrt(variance) / nuisance.known_before;
    others.col(k).head(rows) = seen.design.col(nuisance.column);
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
  if (!(own.norm() > least_own_share * whole)) return {0, INFINITY};
  return {own.dot(residual) / own.squaredNorm(), variance / own.squaredNorm()};
}

std::optional<ScatterBetweenShapes> scatter_between(const std::vector<ShapeEstimate>& estimates,
                                                    double quantile) {
  std::vector<ShapeEstimate> telling;
  std::copy_if(estimates.begin(), estimates.end(), std::back_inserter(telling),
               [](const ShapeEstimate& one) { return std::isfinite(one.variance); });
  if (telling.size() < 2) return std::nullopt;
  const auto freedom = static_cast<double>(telling.size() - 1);
  const Spread together = spread(telling, 0);
  const double chance = gsl_cdf_chisq_Q(together.squares, freedom);
  if (!(chance < significant_chance)) return std::nullopt;
  const double between = variance_between(telling, freedom);
  const double with =
      gsl_cdf_tdist_Pinv(0.975, freedom) / std::sqrt(spread(telling, between).precision);
  const double without = quantile / std::sqrt(together.precision);
  return ScatterBetweenShapes{.relative_deviation = std::sqrt(between),
                              .chance = chance,
                              .widening = std::max(1.0, with / without)};
}

}  // namespace dlo::compare
