#include <Eigen/Dense>

#include "base/legendre.hpp"
#include "dynamics/span_integrator.hpp"

namespace dlo::energy_model {
namespace {

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
  rule.to_legendre = at_nodes.inverse();
  rule.inner = integrated * rule.to_legendre;
  rule.weights = rule.to_legendre.row(0).transpose();
  rule.double_integrals = rule.inner * rule.inner;
  rule.last = rule.weights.transpose() * rule.inner;
  return rule;
}

}  // namespace

Eigen::RowVectorXd CollocationRule::interpolation(double at) const {
  Eigen::VectorXd values(nodes.size());
  Eigen::VectorXd integrals(nodes.size());
  legendre(at, values, integrals);
  return values.transpose() * to_legendre;
}

Eigen::MatrixXd CollocationRule::extrapolation(double ratio) const {
  Eigen::MatrixXd result(nodes.size(), nodes.size());
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    result.row(i) = interpolation(1 + ratio * nodes[i]);
  }
  return result;
}

CollocationRule gauss_rule() {
  constexpr double inner = 0.339981043584856264802665759103;
  constexpr double outer = 0.861136311594052575223946488893;
  return rule_at(Eigen::Vector4d(-outer, -inner, inner, outer));
}

CollocationRule radau_rule() {
  return rule_at(
      Eigen::Vector4d(-0.822824080974592105, -0.181066271118530578, 0.575318923521694113, 1));
}

}  // namespace dlo::energy_model
