#include "least_squares/gauss_newton.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Size of a frame column, divided by the largest, up to which it is rounding: a flat shape has no
/// residuals in its third coordinate.
constexpr double frame_rank_tolerance = 1e-8;
/// Eigenvalue up to which the numbers' information, scaled to a unit diagonal, is singular; two
/// columns then agree to its root.
constexpr double information_tolerance = 1e-12;
/// Component of a number in a null direction of the information above which the number is not
/// identified.
constexpr double least_part = 1e-3;

Eigen::MatrixXd information_of(const LinearFit& fit, double variance) {
  Eigen::MatrixXd information = fit.design.transpose() * fit.design / variance;
  information.diagonal() += fit.prior_inverse_deviations.cwiseAbs2();
  return information;
}

/// Returns the gradient of the log posterior density by the numbers, which is minus half that of
/// the deviance: the sum of squares divided by the variance, plus the priors' terms.
Eigen::VectorXd log_posterior_gradient(const LinearFit& fit, double variance,
                                       const Eigen::VectorXd& values) {
  return fit.design.transpose() * fit.residual / variance -
         fit.prior_inverse_deviations.cwiseAbs2().cwiseProduct(values);
}

/// Returns the logarithm of the determinant of half the deviance's second derivatives by all
/// numbers except the first, without those that neither points nor priors determine.
double log_determinant(const LinearFit& fit, double variance) {
  const Eigen::Index others = fit.design.cols() - 1;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> information(
      information_of(fit, variance).bottomRightCorner(others, others));
  return information.matrixQR().diagonal().head(information.rank()).array().abs().log().sum();
}

constexpr int most_steps = 30;
constexpr int most_halvings = 8;
/// Predicted decrease of the deviance in one step of a profile's chord iteration below which the
/// iteration ends. With it the root of a deviance of 4, at the end of an interval, is accurate to
/// 1e-6.
constexpr double deviance_tolerance = 1e-5;

/// Returns the step of all numbers except the first to the least deviance, if the first one moves
/// by `first_step`.
/// @param gradient  result of log_posterior_gradient(), of all numbers
Eigen::VectorXd step_of_others(const LinearFit& fit, double variance,
                               const Eigen::VectorXd& gradient, double first_step) {
  const Eigen::Index others = fit.design.cols() - 1;
  const auto of_others = fit.design.rightCols(others);
  Eigen::MatrixXd information = of_others.transpose() * of_others / variance;
  information.diagonal() += fit.prior_inverse_deviations.tail(others).cwiseAbs2();
  const Eigen::VectorXd left =
      gradient.tail(others) - of_others.transpose() * fit.design.col(0) / variance * first_step;
  return information.completeOrthogonalDecomposition().solve(left);
}

/// Linearises a fit.
/// @param frames  number of columns of the series' design, before those of the numbers, that belong
/// to frames
LinearFit linear_fit(const std::vector<ResidualSeries>& series, const ErrorCovariance& covariance,
                     Eigen::Index frames, const Eigen::VectorXd& prior_inverse_deviations) {
  Innovations whitened = innovations(series, covariance);
  LinearFit result{whitened.design.rightCols(whitened.design.cols() - frames),
                   std::move(whitened.residual), prior_inverse_deviations, whitened.design.rows()};
  if (frames == 0) return result;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(whitened.design.leftCols(frames));
  qr.setThreshold(frame_rank_tolerance);
  const Eigen::MatrixXd basis =
      qr.householderQ() * Eigen::MatrixXd::Identity(whitened.design.rows(), qr.rank());
  result.design -= basis * (basis.transpose() * result.design).eval();
  result.residual -= basis * (basis.transpose() * result.residual).eval();
  result.freedom -= qr.rank();
  return result;
}

}  // namespace

Eigen::MatrixXd posterior(const LinearFit& fit, double variance) {
  return information_of(fit, variance).completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::MatrixXd sandwich_covariance(const std::vector<ResidualSeries>& series, const LinearFit& fit,
                                    double weight, const ErrorCovariance& errors, double variance) {
  const Eigen::MatrixXd inverse = posterior(fit, weight);
  Eigen::MatrixXd scatter = covariance_products(series, fit.design, errors);
  scatter *= variance / (weight * weight);
  scatter.diagonal() += fit.prior_inverse_deviations.cwiseAbs2();
  return inverse * scatter * inverse;
}

VarianceEstimate variance_under(const std::vector<ResidualSeries>& series,
                                const ErrorCovariance& errors, Eigen::Index frames) {
  const LinearFit fit = linear_fit(series, errors, frames, {});
  const Eigen::MatrixXd basis = basis_of(fit.design);
  const auto freedom = static_cast<double>(fit.freedom - basis.cols());
  const Eigen::VectorXd left = fit.residual - basis * (basis.transpose() * fit.residual).eval();
  return {left.squaredNorm() / std::max(1.0, freedom), freedom};
}

std::vector<bool> undetermined_numbers(const LinearFit& fit, double variance) {
  const Eigen::MatrixXd information = information_of(fit, variance);
  const Eigen::VectorXd deviations =
      information.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.0; });
  const Eigen::MatrixXd scaled = deviations.asDiagonal() * information * deviations.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  std::vector<bool> result(static_cast<std::size_t>(information.rows()), false);
  for (Eigen::Index k = 0; k < information.rows(); ++k) {
    if (eigen.eigenvalues()[k] > information_tolerance) continue;
    for (Eigen::Index i = 0; i < information.rows(); ++i) {
      if (std::abs(eigen.eigenvectors()(i, k)) > least_part) {
        result[static_cast<std::size_t>(i)] = true;
      }
    }
  }
  return result;
}

GaussNewton::GaussNewton(FittedRods& rods, Eigen::VectorXd values,
                         const GaussNewtonOptions& options)
    : rods_(rods),
      options_(options),
      prior_inverse_deviations_(values.size()),
      values_(std::move(values)) {
  for (Eigen::Index k = 0; k < prior_inverse_deviations_.size(); ++k) {
    prior_inverse_deviations_[k] = 1 / rods.unknowns()[static_cast<std::size_t>(k)].prior_deviation;
  }
}

double GaussNewton::penalty(const Eigen::VectorXd& values) const {
  return values.cwiseProduct(prior_inverse_deviations_).squaredNorm();
}

double GaussNewton::deviance() const {
  return linear_.residual.squaredNorm() / weight() + penalty(values_);
}

LinearFit GaussNewton::linearised(const std::vector<ResidualSeries>& series) const {
  return linear_fit(series, {}, rods_.measured().frame_columns(), prior_inverse_deviations_);
}

double GaussNewton::deviance_at(const Eigen::VectorXd& values) {
  const std::optional<std::vector<ResidualSeries>> series =
      rods_.residuals(values, FittedRods::Columns::frames);
  if (!series) return INFINITY;
  return linearised(*series).residual.squaredNorm() / weight() + penalty(values);
}

void GaussNewton::measure_variance() {
  if (options_.noise) {
    variance_ = std::pow(*options_.noise, 2);
    freedom_ = static_cast<double>(linear_.freedom);
    return;
  }
  const double floor = std::pow(options_.least_noise, 2);
  const double sum_of_squares = linear_.residual.squaredNorm();
  if (!(variance_ > 0)) {
    variance_ = std::max(floor, sum_of_squares / static_cast<double>(linear_.freedom));
  }
  // A number that is determined by its prior does not reduce the degrees of freedom.
  const Eigen::VectorXd kept =
      posterior(linear_, weight()).diagonal().cwiseProduct(prior_inverse_deviations_.cwiseAbs2());
  freedom_ = static_cast<double>(linear_.freedom - prior_inverse_deviations_.size()) + kept.sum();
  if (!(freedom_ >= 1)) {
    throw InputError(
        fmt::format("calibrate: {} measured numbers in addition to the frames for {} unknown "
                    "parameters (allowed: more measured numbers, so more points, or a given noise)",
                    linear_.freedom, prior_inverse_deviations_.size()));
  }
  variance_ = std::max(floor, sum_of_squares / freedom_);
}

bool GaussNewton::descend() {
  for (int i = 0;; ++i) {
    std::optional<std::vector<ResidualSeries>> series =
        rods_.residuals(values_, FittedRods::Columns::all);
    if (!series) return false;
    series_ = std::move(*series);
    here_ = rods_.rods();
    linear_ = linearised(series_);
    measure_variance();
    posterior_ = posterior(linear_, weight());
    // All results must belong to the final values, so no step is made after the last linearisation.
    if (i == most_steps) return true;
    Eigen::VectorXd step = next_step();
    const Eigen::VectorXd deviations = posterior_.diagonal().cwiseSqrt();
    if ((step.array().abs() <= last_step(deviations[0]) * deviations.array()).all()) return true;
    const double here = deviance();
    const double predicted = (linear_.residual - linear_.design * step).squaredNorm() / weight() +
                             penalty(values_ + step);
    if (here - predicted < options_.least_gain * here) return true;
    // Every trial starts from the current rods, not from those of a longer trial step.
    int halvings = 0;
    while (halvings < most_halvings && !(deviance_at(values_ + step) < here)) {
      rods_.set_initial_rods(here_);
      step /= 2;
      ++halvings;
    }
    // No decrease along a direction of descent is left except rounding.
    if (halvings == most_halvings) return true;
    values_ += step;
  }
}

/// Returns the relative step at which the iteration ends. A first number whose deviation exceeds
/// its longest step is not identified: its deviance is a flat valley, in which even small shares of
/// its large deviation move it far. There the iteration ends earlier.
double GaussNewton::last_step(double first_deviation) const {
  constexpr double valley_step_tolerance = 0.01;
  const bool in_valley = first_deviation > rods_.unknowns().front().longest_step;
  return in_valley ? std::max(valley_step_tolerance, options_.last_step) : options_.last_step;
}

/// Returns the step to the least deviance of the linear problem, with the first number limited to
/// its bounds and longest step: a first number that the shapes hardly determine would move far
/// away, and the others with it. If another number exceeds its longest step, the whole step is
/// shortened.
Eigen::VectorXd GaussNewton::next_step() const {
  const std::vector<Unknown>& unknowns = rods_.unknowns();
  const Eigen::VectorXd down = log_posterior_gradient(linear_, weight(), values_);
  Eigen::VectorXd step = posterior_ * down;
  const double longest = unknowns.front().longest_step;
  const double bounded = std::clamp(values_[0] + std::clamp(step[0], -longest, longest),
                                    options_.lowest, options_.highest);
  if (values_[0] + step[0] != bounded) {
    step[0] = bounded - values_[0];
    if (step.size() > 1) {
      step.tail(step.size() - 1) = step_of_others(linear_, weight(), down, step[0]);
    }
  }
  double share = 1;
  for (Eigen::Index k = 1; k < step.size(); ++k) {
    const double longest_step = unknowns[static_cast<std::size_t>(k)].longest_step;
    if (std::abs(step[k]) > longest_step) {
      share = std::min(share, longest_step / std::abs(step[k]));
    }
  }
  return share * step;
}

double GaussNewton::marginal_slope() {
  const Eigen::Index others = prior_inverse_deviations_.size() - 1;
  const double offset = std::sqrt(posterior_(0, 0)) / 2;
  if (others == 0 || !(offset > 0) || !std::isfinite(offset)) return 0;
  double difference = 0;
  for (const double side : {1.0, -1.0}) {
    rods_.set_initial_rods(here_);
    const std::optional<std::vector<ResidualSeries>> series =
        rods_.residuals(conditional_optimum(values_[0] + side * offset), FittedRods::Columns::all);
    if (!series) return 0;
    difference += side * log_determinant(linearised(*series), weight());
  }
  return difference / (2 * offset);
}

Eigen::VectorXd GaussNewton::conditional_optimum(double first) const {
  return values_ + posterior_.col(0) / posterior_(0, 0) * (first - values_[0]);
}

double GaussNewton::profile(double first) {
  const Eigen::Index others = prior_inverse_deviations_.size() - 1;
  Eigen::VectorXd values = conditional_optimum(first);
  double least = INFINITY;
  LinearFit chord = linear_;
  constexpr int most_chords = 20;
  for (int i = 0; i < most_chords; ++i) {
    const std::optional<std::vector<ResidualSeries>> series =
        rods_.residuals(values, FittedRods::Columns::frames);
    if (!series) break;
    chord.residual = linearised(*series).residual;
    const double here = chord.residual.squaredNorm() / weight() + penalty(values);
    if (!(here < least)) break;
    least = here;
    if (others == 0) break;
    const Eigen::VectorXd down = log_posterior_gradient(chord, weight(), values);
    const Eigen::VectorXd step = step_of_others(chord, weight(), down, 0);
    if (step.dot(down.tail(others)) < deviance_tolerance) break;
    values.tail(others) += step;
  }
  return least;
}

}  // namespace dlo::compare
