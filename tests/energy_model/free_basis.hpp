#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

namespace dlo::test {

/// Returns an orthonormal basis of the directions that constraints leave free.
inline Eigen::MatrixXd free_basis(const Eigen::MatrixXd& jacobian, Eigen::Index size) {
  if (jacobian.rows() == 0) return Eigen::MatrixXd::Identity(size, size);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian.transpose());
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(size - jacobian.rows());
}

}  // namespace dlo::test
