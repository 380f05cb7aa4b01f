#include "least_squares/error_correlation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

namespace dlo::compare {
namespace {

/// Smallest number of residuals beyond the fitted numbers for which a correlation is estimated.
constexpr Eigen::Index least_degrees_of_freedom = 5;
/// Norm of the part of a design column that is linearly independent of the other columns, divided
/// by the norm of the column, up to which the column counts as dependent. Columns of
/// MaterialProfiles are differences of shapes over strides of 1e-3. Their relative error is about
/// 1e-6: shapes are accurate to 1e-10 l, and derivatives of shapes are about 0.1 l.
constexpr double rank_tolerance = 1e-6;
/// Gain of twice the log likelihood that independent errors reach in one case of twenty or fewer.
/// It lies between the 2.71 of one parameter at its bound and the 5.99 of two (measured: see the
/// tests).
constexpr double significant_gain = 5;

/// All series concatenated. Where a new series begins, the errors are independent of those before.
struct Stacked {
  Eigen::VectorXd residual;
  Eigen::MatrixXd design;
  std::vector<double> step;  // arc length since the row before [m]; infinite at first rows
};

Stacked stacked(const std::vector<ResidualSeries>& series) {
  Eigen::Index rows = 0;
  for (const ResidualSeries& one : series) rows += one.residual.size();
  Stacked result;
  const Eigen::Index columns = series.empty() ? 0 : series.front().design.cols();
  result.residual.resize(rows);
  result.design.resize(rows, columns);
  Eigen::Index row = 0;
  for (const ResidualSeries& one : series) {
    const Eigen::Index count = one.residual.size();
    result.residual.segment(row, count) = one.residual;
    result.design.middleRows(row, count) = one.design;
    for (std::size_t i = 0; i < one.arc_length.size(); ++i) {
      result.step.push_back(i == 0 ? INFINITY
                                   : std::max(0.0, one.arc_length[i] - one.arc_length[i - 1]));
    }
    row += count;
  }
  return result;
}

/// Columns transformed into independent innovations of unit variance by the Kalman filter of
/// ErrorCovariance. The filter's state is the correlated part, with variance `share`.
struct Whitened {
  Eigen::MatrixXd columns;
  double log_determinant = 0;  // logarithm of the determinant of the covariance
};

Whitened whitened(Eigen::MatrixXd columns, const std::vector<double>& step,
                  const ErrorCovariance& covariance) {
  const double white = 1 - covariance.share;
  Whitened result;
  Eigen::RowVectorXd state = Eigen::RowVectorXd::Zero(columns.cols());
  double variance = covariance.share;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double correlation = std::exp(-step[static_cast<std::size_t>(i)] / covariance.length);
    state *= correlation;
    variance =
        correlation * correlation * variance + (1 - correlation * correlation) * covariance.share;
    // Errors at equal arc lengths without white noise would be identical, with zero innovation.
    const double innovation = std::max(variance + white, 1e-12);
    const double gain = variance / innovation;
    const Eigen::RowVectorXd gap = columns.row(i) - state;
    columns.row(i) = gap / std::sqrt(innovation);
    result.log_determinant += std::log(innovation);
    state += gain * gap;
    variance *= white / innovation;
  }
  result.columns = std::move(columns);
  return result;
}

/// Returns -2 times the restricted log likelihood, up to a constant.
double deviance(const Eigen::VectorXd& residual, const Eigen::MatrixXd& basis,
                const std::vector<double>& step, const ErrorCovariance& covariance) {
  const Eigen::Index rank = basis.cols();
  Eigen::MatrixXd columns(basis.rows(), rank + 1);
  columns << basis, residual;
  const Whitened white = whitened(std::move(columns), step, covariance);
  const auto design = white.columns.leftCols(rank);
  const Eigen::VectorXd errors = white.columns.col(rank);
  double sum_of_squares = errors.squaredNorm();
  double log_determinant = white.log_determinant;
  if (rank > 0) {
    const Eigen::LLT<Eigen::MatrixXd> normal(design.transpose() * design);
    const Eigen::VectorXd moment = design.transpose() * errors;
    sum_of_squares -= moment.dot(normal.solve(moment));
    const Eigen::MatrixXd factor = normal.matrixL();
    log_determinant += 2 * factor.diagonal().array().log().sum();
  }
  const auto freedom = static_cast<double>(basis.rows() - rank);
  return freedom * std::log(sum_of_squares / freedom) + log_determinant;
}

/// Returns the series with at most 250 rows each, at equal intervals. That is enough to distinguish
/// covariances, of which hundreds are tried.
std::vector<ResidualSeries> thinned(const std::vector<ResidualSeries>& series) {
  constexpr Eigen::Index most_rows = 250;
  std::vector<ResidualSeries> result = series;
  for (ResidualSeries& one : result) {
    const Eigen::Index every = (one.residual.size() + most_rows - 1) / most_rows;
    if (every <= 1) continue;
    const Eigen::Index rows = (one.residual.size() - 1) / every + 1;
    for (Eigen::Index row = 1; row < rows; ++row) {
      one.arc_length[static_cast<std::size_t>(row)] =
          one.arc_length[static_cast<std::size_t>(row * every)];
      one.residual[row] = one.residual[row * every];
      one.design.row(row) = one.design.row(row * every);
    }
    one.arc_length.resize(static_cast<std::size_t>(rows));
    one.residual.conservativeResize(rows);
    one.design.conservativeResize(rows, Eigen::NoChange);
  }
  return result;
}

/// A covariance of the search grid, and its deviance.
struct Candidate {
  ErrorCovariance covariance;
  double deviance = 0;
};

/// Returns the covariances of the grid, independent errors first; empty with too few residuals.
std::vector<Candidate> candidates(const std::vector<ResidualSeries>& whole) {
  const std::vector<ResidualSeries> series = thinned(whole);
  const Stacked all = stacked(series);
  const Eigen::MatrixXd basis = basis_of(all.design);
  if (basis.rows() - basis.cols() < least_degrees_of_freedom) return {};
  double shortest = INFINITY;
  double total = 0;
  for (const ResidualSeries& one : series) {
    if (one.arc_length.size() < 2) continue;
    const double length = one.arc_length.back() - one.arc_length.front();
    // If the rod does not fit, all points of a series may lie at an end of the rod.
    if (!(length > 0)) continue;
    total = std::max(total, length);
    shortest = std::min(shortest, length / static_cast<double>(one.arc_length.size() - 1));
  }
  if (!(total > 0)) return {};
  const auto candidate = [&](const ErrorCovariance& covariance) {
    return Candidate{covariance, deviance(all.residual, basis, all.step, covariance)};
  };
  std::vector<Candidate> result = {candidate({.share = 0, .length = total})};
  constexpr double factor = 1.35;
  for (double length = shortest / 3; length < 2 * total; length *= factor) {
    for (const double share : {0.3, 0.5, 0.7, 0.85, 0.95, 1.0}) {
      result.push_back(candidate({.share = share, .length = length}));
    }
  }
  return result;
}

/// Returns the product of the matrix exp(-|s - s'| / length) and columns, by one pass along the rod
/// and one back.
Eigen::MatrixXd smoothed(const Eigen::MatrixXd& columns, const std::vector<double>& step,
                         double length) {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(columns.cols());
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    sum = sum * std::exp(-step[static_cast<std::size_t>(i)] / length) + columns.row(i);
    result.row(i) = sum;
  }
  sum.setZero();
  for (Eigen::Index i = columns.rows() - 1; i > 0; --i) {
    sum = (sum + columns.row(i)) * std::exp(-step[static_cast<std::size_t>(i)] / length);
    result.row(i - 1) += sum;
  }
  return result;
}

Eigen::MatrixXd covariance_times(const Eigen::MatrixXd& columns, const std::vector<double>& step,
                                 const ErrorCovariance& covariance) {
  return (1 - covariance.share) * columns +
         covariance.share * smoothed(columns, step, covariance.length);
}

/// Returns the sum of the squares of all entries of the covariance.
double squared_entries(const std::vector<double>& step, const ErrorCovariance& covariance) {
  const double a = 1 - covariance.share;
  const double b = covariance.share;
  const auto count = static_cast<Eigen::Index>(step.size());
  const double all = smoothed(Eigen::MatrixXd::Ones(count, 1), step, covariance.length / 2).sum();
  return b * b * all + (a * a + 2 * a * b) * static_cast<double>(count);
}

}  // namespace

Eigen::MatrixXd basis_of(Eigen::MatrixXd columns) {
  if (columns.cols() == 0) return columns;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double norm = columns.col(k).norm();
    if (norm > 0) columns.col(k) /= norm;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(rank_tolerance);
  const Eigen::Index rank = qr.rank();
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), rank);
}

CorrelationEstimate correlation_of(const std::vector<ResidualSeries>& series) {
  const std::vector<Candidate> all = candidates(series);
  CorrelationEstimate result;
  if (all.empty()) return result;
  result.tested = true;
  const auto best = std::min_element(
      all.begin(), all.end(),
      [](const Candidate& a, const Candidate& b) { return a.deviance < b.deviance; });
  result.covariance = best->covariance;
  result.significant = all.front().deviance - best->deviance > significant_gain;
  return result;
}

std::vector<LikelyCovariance> likely_covariances(const std::vector<ResidualSeries>& series) {
  const std::vector<Candidate> all = candidates(series);
  if (all.empty()) return {{ErrorCovariance(), 1}};
  double least = INFINITY;
  for (const Candidate& one : all) least = std::min(least, one.deviance);
  constexpr double least_relative_likelihood = 1e-3;
  std::vector<LikelyCovariance> result;
  double sum = 0;
  for (const Candidate& one : all) {
    const double weight = std::exp((least - one.deviance) / 2);
    if (!(weight >= least_relative_likelihood)) continue;
    result.push_back({one.covariance, weight});
    sum += weight;
  }
  for (LikelyCovariance& one : result) one.weight /= sum;
  return result;
}

Innovations innovations(const std::vector<ResidualSeries>& series,
                        const ErrorCovariance& covariance) {
  Stacked all = stacked(series);
  if (!(covariance.share > 0)) return {std::move(all.residual), std::move(all.design)};
  Eigen::MatrixXd columns(all.residual.size(), all.design.cols() + 1);
  columns << all.design, all.residual;
  const Eigen::MatrixXd white = whitened(std::move(columns), all.step, covariance).columns;
  return {white.rightCols<1>(), white.leftCols(all.design.cols())};
}

Eigen::MatrixXd covariance_products(const std::vector<ResidualSeries>& series,
                                    const Eigen::MatrixXd& columns,
                                    const ErrorCovariance& covariance) {
  if (!(covariance.share > 0)) return columns.transpose() * columns;
  return columns.transpose() * covariance_times(columns, stacked(series).step, covariance);
}

CorrelationEffect correlation_effect(const std::vector<ResidualSeries>& series, Eigen::Index column,
                                     const ErrorCovariance& covariance) {
  const Stacked all = stacked(series);
  const Eigen::MatrixXd basis = basis_of(all.design);
  const auto count = static_cast<double>(basis.rows());
  const auto rank = static_cast<double>(basis.cols());
  CorrelationEffect result;
  result.degrees_of_freedom = count - rank;
  if (!(covariance.share > 0)) return result;
  const Eigen::MatrixXd moved = covariance_times(basis, all.step, covariance);
  const Eigen::MatrixXd inner = basis.transpose() * moved;
  // Traces of P C and P C P C, with the projector P = 1 - Q Q' onto the residuals.
  const double mean = count - inner.trace();
  const double sum_of_squares =
      squared_entries(all.step, covariance) - 2 * moved.squaredNorm() + inner.squaredNorm();
  result.degrees_of_freedom = std::clamp(mean * mean / sum_of_squares, 1.0, count - rank);
  result.residual_factor = mean / (count - rank);
  Eigen::MatrixXd others(basis.rows(), all.design.cols() - 1);
  others << all.design.leftCols(column), all.design.rightCols(all.design.cols() - 1 - column);
  const Eigen::MatrixXd nuisance = basis_of(others);
  Eigen::VectorXd own = all.design.col(column);
  own -= nuisance * (nuisance.transpose() * own).eval();
  const double norm = own.squaredNorm();
  if (!(norm > 0)) return result;
  result.variance_factor = own.dot(covariance_times(own, all.step, covariance).col(0)) / norm;
  return result;
}

}  // namespace dlo::compare
