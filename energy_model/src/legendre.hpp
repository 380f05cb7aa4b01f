#pragma once

#include <Eigen/Core>

namespace dlo::energy_model {

/// Orthonormal Legendre polynomials p_k on [0, 1] at the nodes of a Gauss-Legendre rule.
struct LegendreTable {
  Eigen::VectorXd nodes;      ///< Q
  Eigen::VectorXd weights;    ///< Q, sum 1
  Eigen::MatrixXd values;     ///< p_k at the nodes, Q x K
  Eigen::MatrixXd integrals;  ///< int_0^node p_k, Q x K
};

/// Values p_k(xi) and integrals int_0^xi p_k for k = 0 .. K-1 into `values` and `integrals`.
void legendre(double xi, Eigen::Ref<Eigen::VectorXd> values, Eigen::Ref<Eigen::VectorXd> integrals);

/// Table of K terms, made once and kept. Safe to call from several threads.
/// The rule has K + 6 nodes: for a tangent angle of degree K the sines and cosines of the integrand
/// are then resolved as far as the angle itself is.
[[nodiscard]] const LegendreTable& legendre_table(int terms);

/// Largest number of terms that legendre_table knows.
inline constexpr int max_terms = 128;

}  // namespace dlo::energy_model
