#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

#include "../helpers.hpp"

namespace dlo::test {

/// Returns a symmetric matrix with these eigenvalues.
inline Eigen::MatrixXd with_eigenvalues(const Eigen::VectorXd& eigenvalues) {
  const Eigen::Index n = eigenvalues.size();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd::Random(n, n));
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q * eigenvalues.asDiagonal() * Q.transpose();
}

}  // namespace dlo::test
