#include "least_squares/linear_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

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

Eigen::MatrixXd information_of(const LinearFit& fit, double variance,
                               const Eigen::VectorXd& before) {
  Eigen::MatrixXd information = fit.design.transpose() * fit.design / variance;
  information.diagonal() += before.cwiseAbs2();
  return information;
}

}  // namespace

LinearFit linear_fit(const std::vector<ResidualSeries>& series, const ErrorCovariance& covariance,
                     Eigen::Index frames) {
  Innovations seen = innovations(series, covariance);
  LinearFit result{seen.design.rightCols(seen.design.cols() - frames), std::move(seen.residual),
                   seen.design.rows()};
  if (frames == 0) return result;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(seen.design.leftCols(frames));
  qr.setThreshold(frame_rank_tolerance);
  const Eigen::MatrixXd basis =
      qr.householderQ() * Eigen::MatrixXd::Identity(seen.design.rows(), qr.rank());
  result.design -= basis * (basis.transpose() * result.design).eval();
  result.residual -= basis * (basis.transpose() * result.residual).eval();
  result.freedom -= qr.rank();
  return result;
}

Eigen::MatrixXd posterior(const LinearFit& fit, double variance, const Eigen::VectorXd& before) {
  return information_of(fit, variance, before).completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::MatrixXd posterior_under(const std::vector<ResidualSeries>& series, const LinearFit& fit,
                                double weight, const Eigen::VectorXd& before,
                                const ErrorCovariance& errors, double variance) {
  const Eigen::MatrixXd inverse = posterior(fit, weight, before);
  Eigen::MatrixXd scatter = covariance_products(series, fit.design, errors);
  scatter *= variance / (weight * weight);
  scatter.diagonal() += before.cwiseAbs2();
  return inverse * scatter * inverse;
}

VarianceEstimate variance_under(const std::vector<ResidualSeries>& series,
                                const ErrorCovariance& errors, Eigen::Index frames) {
  const LinearFit fit = linear_fit(series, errors, frames);
  const Eigen::MatrixXd basis = basis_of(fit.design);
  const auto freedom = static_cast<double>(fit.freedom - basis.cols());
  const Eigen::VectorXd left = fit.residual - basis * (basis.transpose() * fit.residual).eval();
  return {left.squaredNorm() / std::max(1.0, freedom), freedom};
}

std::vector<bool> unseen(const LinearFit& fit, double variance, const Eigen::VectorXd& before) {
  const Eigen::MatrixXd information = information_of(fit, variance, before);
  const Eigen::VectorXd deviations =
      information.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.0; });
  const Eigen::MatrixXd scaled = deviations.asDiagonal() * information * deviations.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  std::vector<bool> result(static_cast<std::size_t>(before.size()), false);
  for (Eigen::Index k = 0; k < before.size(); ++k) {
    if (eigen.eigenvalues()[k] > information_tolerance) continue;
    for (Eigen::Index i = 0; i < before.size(); ++i) {
      if (std::abs(eigen.eigenvectors()(i, k)) > least_part) {
        result[static_cast<std::size_t>(i)] = true;
      }
    }
  }
  return result;
}

Eigen::VectorXd slope(const LinearFit& fit, double variance, const Eigen::VectorXd& before,
                      const Eigen::VectorXd& values) {
  return fit.design.transpose() * fit.residual / variance - before.cwiseAbs2().cwiseProduct(values);
}

double log_determinant(const LinearFit& fit, double variance, const Eigen::VectorXd& before) {
  const Eigen::Index others = before.size() - 1;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> information(
      information_of(fit, variance, before).bottomRightCorner(others, others));
  return information.matrixQR().diagonal().head(information.rank()).array().abs().log().sum();
}

Eigen::VectorXd step_of_others(const LinearFit& fit, double variance, const Eigen::VectorXd& before,
                               const Eigen::VectorXd& slope, double held) {
  const Eigen::Index others = before.size() - 1;
  const auto of_others = fit.design.rightCols(others);
  Eigen::MatrixXd information = of_others.transpose() * of_others / variance;
  information.diagonal() += before.tail(others).cwiseAbs2();
  const Eigen::VectorXd left =
      slope.tail(others) - of_others.transpose() * fit.design.col(0) / variance * held;
  return information.completeOrthogonalDecomposition().solve(left);
}

}  // namespace dlo::compare
