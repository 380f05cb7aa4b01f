#include "fit/linear_fit.hpp"

#include <Eigen/QR>
#include <utility>

namespace dlo::compare {
namespace {

/// Columns of frames that are no more than this share of the largest are rounding: a flat shape
/// does not see its third coordinate.
constexpr double frame_rank_tolerance = 1e-8;

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
  Eigen::MatrixXd information = fit.design.transpose() * fit.design / variance;
  information.diagonal() += before.cwiseAbs2();
  return information.completeOrthogonalDecomposition().pseudoInverse();
}

Eigen::VectorXd slope(const LinearFit& fit, double variance, const Eigen::VectorXd& before,
                      const Eigen::VectorXd& values) {
  return fit.design.transpose() * fit.residual / variance - before.cwiseAbs2().cwiseProduct(values);
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
