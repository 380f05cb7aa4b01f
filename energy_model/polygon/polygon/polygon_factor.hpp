#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace dlo::energy_model {

/// Factors of H = A + B B^T + shift, with A symmetric and banded and B of few columns, computed in
/// O(rows): L D L^T of A + shift by GSL, and S = 1 + B^T (A + shift)^-1 B. The bordered matrix
///     [ A + shift  B ]
///     [ B^T       -1 ]
/// has the negative eigenvalues of H and one more for each column of B. It also has the negative
/// eigenvalues of A + shift and those of -S (Haynsworth).
class PolygonFactor {
 public:
  /// Factorises H.
  /// @param band  lower half of A, A(j + d, j) in row d and column j; at most as many rows as
  ///              columns
  /// @param B     rows x 0 if there is none
  /// @return whether H is positive definite
  bool compute(const Eigen::MatrixXd& band, const Eigen::MatrixXd& B, double shift);
  /// Returns H^-1 times a vector.
  [[nodiscard]] Eigen::VectorXd solve(Eigen::VectorXd right);

 private:
  void solve_banded(Eigen::Ref<Eigen::VectorXd> vector);

  Eigen::MatrixXd factor_;  // D in the first row, L below
  Eigen::MatrixXd B_;
  Eigen::MatrixXd carried_;  // (A + shift)^-1 B
  Eigen::PartialPivLU<Eigen::MatrixXd> small_;
};

}  // namespace dlo::energy_model
