#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/legendre.hpp"
#include "dynamics/span_integrator.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the matrix whose eigenvalues are the roots of Legendre's polynomial (Golub and Welsch).
Eigen::MatrixXd jacobi_matrix(int stages) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(stages, stages);
  for (int i = 1; i < stages; ++i) {
    result(i, i - 1) = i / std::sqrt(4.0 * i * i - 1);
    result(i - 1, i) = result(i, i - 1);
  }
  return result;
}

/// Returns the collocation rule of given nodes. @param nodes  on [-1, 1]
CollocationRule rule_at(const Eigen::VectorXd& nodes) {
  const Eigen::Index stages = nodes.size();
  CollocationRule rule;
  rule.nodes = (1 + nodes.array()) / 2;
  Eigen::VectorXd values(stages);
  Eigen::VectorXd integrals(stages);
  Eigen::MatrixXd at_nodes(stages, stages);
  Eigen::MatrixXd integrated(stages, stages);
  for (Eigen::Index i = 0; i < stages; ++i) {
    legendre(rule.nodes[i], values, integrals);
    at_nodes.row(i) = values;
    integrated.row(i) = integrals;
  }
  rule.through = at_nodes.inverse();
  rule.inner = integrated * rule.through;
  rule.weights = rule.through.row(0).transpose();
  rule.twice = rule.inner * rule.inner;
  rule.last = rule.weights.transpose() * rule.inner;
  return rule;
}

}  // namespace

Eigen::RowVectorXd CollocationRule::interpolation(double at) const {
  Eigen::VectorXd values(nodes.size());
  Eigen::VectorXd integrals(nodes.size());
  legendre(at, values, integrals);
  return values.transpose() * through;
}

Eigen::MatrixXd CollocationRule::extrapolation(double ratio) const {
  Eigen::MatrixXd result(nodes.size(), nodes.size());
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    result.row(i) = interpolation(1 + ratio * nodes[i]);
  }
  return result;
}

CollocationRule gauss_rule(int stages) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi_matrix(stages));
  return rule_at(solver.eigenvalues());
}

CollocationRule radau_rule(int stages) {
  // The last diagonal entry makes 1 an eigenvalue (Golub). It is 1 - b^2 p_(n-1)(1) / p_n(1) with n
  // = stages - 1, monic polynomials p and the last off-diagonal entry b; for Legendre's polynomials
  // that is (n + 1) / (2 n + 1).
  Eigen::MatrixXd jacobi = jacobi_matrix(stages);
  jacobi(stages - 1, stages - 1) = stages / (2.0 * stages - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  Eigen::VectorXd nodes = solver.eigenvalues();
  nodes[stages - 1] = 1;
  return rule_at(nodes);
}

}  // namespace dlo::energy_model
