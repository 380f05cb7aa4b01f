#include "linear/free_directions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
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

double smallest_eigenvalue(FreeHessian& hessian) {
  if (const std::optional<double> smallest = hessian.smallest_of_definite()) return *smallest;
  const Eigen::MatrixXd projected = hessian.matrix();
  if (projected.size() == 0) return 1;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

double smallest_eigenvalue(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  FreeHessian on_free_directions;
  on_free_directions.compute(hessian, jacobian);
  return smallest_eigenvalue(on_free_directions);
}

Eigen::VectorXd eigenvalues_by_size(const FreeHessian& hessian) {
  const Eigen::MatrixXd projected = hessian.matrix();
  if (projected.size() == 0) return {};
  Eigen::VectorXd found =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected, Eigen::EigenvaluesOnly)
          .eigenvalues();
  std::sort(found.begin(), found.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  return found;
}

Eigen::VectorXd direction_by_size(FreeHessian& hessian, Eigen::Index index) {
  if (index == 0) {
    if (const std::optional<Eigen::VectorXd> softest = hessian.softest_of_definite()) {
      return hessian.in_unknowns(*softest);
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

namespace {

struct Softest {
  double eigenvalue;
  Eigen::VectorXd direction;
};

std::optional<Softest> softest(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  FreeHessian on_free_directions;
  on_free_directions.compute(hessian, jacobian);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(on_free_directions.matrix());
  if (eigen.eigenvalues().size() == 0) return std::nullopt;
  return Softest{eigen.eigenvalues()[0],
                 on_free_directions.in_unknowns(eigen.eigenvectors().col(0)).normalized()};
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
