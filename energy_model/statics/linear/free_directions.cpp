#include "linear/free_directions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace dlo::energy_model {

Eigen::VectorXd smallest_eigenvalues(ReducedHessian& hessian, double above) {
  const std::optional<double> smallest = hessian.smallest_eigenvalue_of_definite();
  if (smallest && *smallest > above) return Eigen::VectorXd::Constant(1, *smallest);
  const Eigen::MatrixXd projected = hessian.matrix();
  if (projected.size() == 0) return {};
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::VectorXd direction_by_size(ReducedHessian& hessian, Eigen::Index index) {
  if (index == 0) {
    if (const std::optional<Eigen::VectorXd> mode = hessian.lowest_mode_of_definite()) {
      return hessian.in_unknowns(*mode);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.matrix());
  std::vector<Eigen::Index> order(static_cast<std::size_t>(eigen.eigenvalues().size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return std::abs(eigen.eigenvalues()[a]) < std::abs(eigen.eigenvalues()[b]);
  });
  return hessian.in_unknowns(eigen.eigenvectors().col(order.at(static_cast<std::size_t>(index))));
}

bool is_minimum(const Eigen::MatrixXd& hessian) {
  Eigen::MatrixXd shifted = hessian;
  shifted.diagonal().array() += neutral;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(shifted).info() == Eigen::Success;
}

std::optional<Eigen::VectorXd> negative_curvature_direction(const ReducedHessian& hessian) {
  if (hessian.is_definite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian.matrix());
  if (eigen.eigenvalues().size() == 0 || eigen.eigenvalues()[0] > -neutral) return std::nullopt;
  return hessian.in_unknowns(eigen.eigenvectors().col(0)).normalized();
}

}  // namespace dlo::energy_model
