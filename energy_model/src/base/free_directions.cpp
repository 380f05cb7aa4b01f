#include "base/free_directions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

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

namespace {

/// Z^T H Z with Z = free_directions(), which is not formed.
Eigen::MatrixXd on_free_directions(const Eigen::MatrixXd& hessian,
                                   const Eigen::MatrixXd& jacobian) {
  if (jacobian.rows() == 0) return hessian;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian.transpose());
  const Eigen::Index left = std::max<Eigen::Index>(0, hessian.rows() - jacobian.rows());
  Eigen::MatrixXd projected = hessian;
  projected.applyOnTheLeft(qr.householderQ().adjoint());
  projected.applyOnTheRight(qr.householderQ());
  return projected.bottomRightCorner(left, left);
}

/// By inverse iteration, of a positive definite matrix of which the lower half is read; below it by
/// less than `slack` of it lies no other, which a factor proves. None if it does not.
std::optional<double> smallest_of_definite(const Eigen::MatrixXd& matrix) {
  constexpr double slack = 0.01;
  constexpr double settled = 1e-5;
  constexpr int most_iterations = 24;
  const Eigen::LLT<Eigen::MatrixXd> llt(matrix);
  if (llt.info() != Eigen::Success) return std::nullopt;
  // Without a symmetry, which a direction could lack.
  Eigen::VectorXd v(matrix.rows());
  for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = std::sin(1 + 1.7 * static_cast<double>(i));
  double smallest = 0;
  for (int i = 0; i < most_iterations; ++i) {
    v.normalize();
    const Eigen::VectorXd before = v;
    llt.solveInPlace(v);
    const double next = before.dot(v) / v.squaredNorm();
    const bool done = std::abs(next - smallest) <= settled * next;
    smallest = next;
    if (done) break;
  }
  Eigen::MatrixXd shifted = matrix;
  shifted.diagonal().array() -= (1 - slack) * smallest;
  if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(shifted).info() != Eigen::Success) {
    return std::nullopt;
  }
  return smallest;
}

}  // namespace

double smallest_eigenvalue(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd projected = on_free_directions(hessian, jacobian);
  if (projected.size() == 0) return 1;
  if (const std::optional<double> smallest = smallest_of_definite(projected)) return *smallest;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

Eigen::VectorXd eigenvalues_by_size(const Eigen::MatrixXd& hessian,
                                    const Eigen::MatrixXd& jacobian) {
  const Eigen::MatrixXd projected = on_free_directions(hessian, jacobian);
  if (projected.size() == 0) return {};
  Eigen::VectorXd found =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
          .eigenvalues();
  std::sort(found.begin(), found.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  return found;
}

Eigen::VectorXd direction_by_size(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                                  Eigen::Index index) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(on_free_directions(hessian, jacobian));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(eigen.eigenvalues().size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(eigen.eigenvalues()[a]) < std::abs(eigen.eigenvalues()[b]);
  });
  return free_directions(jacobian, hessian.rows()) *
         eigen.eigenvectors().col(order.at(static_cast<std::size_t>(index)));
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
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(on_free_directions(hessian, jacobian));
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

std::string moves_for_nothing(int ways) {
  if (ways == 0) return {};
  return ", moves for nothing in " + std::to_string(ways) + (ways == 1 ? " way" : " ways");
}

}  // namespace dlo::energy_model
