#include "base/free_directions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <utility>

namespace dlo::energy_model {

AcrossNeutral::AcrossNeutral(const Eigen::MatrixXd& system)
    : factor_(system.rows(), system.cols()) {
  factor_.setThreshold(neutral / std::max(1.0, system.cwiseAbs().maxCoeff()));
  factor_.compute(system);
}

Eigen::MatrixXd free_directions(const Eigen::MatrixXd& jacobian, Eigen::Index size) {
  if (jacobian.rows() == 0) return Eigen::MatrixXd::Identity(size, size);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian.transpose());
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q.rightCols(size - jacobian.rows());
}

double smallest_eigenvalue(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd Z = free_directions(jacobian, hessian.rows());
  if (Z.cols() == 0) return 1;
  const Eigen::MatrixXd projected = Z.transpose() * hessian * Z;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

bool is_minimum(const Eigen::MatrixXd& hessian) {
  Eigen::MatrixXd shifted = hessian;
  shifted.diagonal().array() += neutral;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(shifted).info() == Eigen::Success;
}

namespace {

struct Softest {
  double eigenvalue;
  Eigen::VectorXd direction;
};

std::optional<Softest> softest(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd Z = free_directions(jacobian, hessian.rows());
  if (Z.cols() == 0) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Z.transpose() * hessian * Z);
  return Softest{eigen.eigenvalues()[0], (Z * eigen.eigenvectors().col(0)).normalized()};
}

}  // namespace

std::optional<Eigen::VectorXd> softest_direction(const Eigen::MatrixXd& hessian,
                                                 const Eigen::MatrixXd& jacobian) {
  std::optional<Softest> found = softest(hessian, jacobian);
  if (!found) return std::nullopt;
  return std::move(found->direction);
}

std::optional<Eigen::VectorXd> falling_direction(const Eigen::MatrixXd& hessian,
                                                 const Eigen::MatrixXd& jacobian) {
  std::optional<Softest> found = softest(hessian, jacobian);
  if (!found || found->eigenvalue > -neutral) return std::nullopt;
  return std::move(found->direction);
}

}  // namespace dlo::energy_model
