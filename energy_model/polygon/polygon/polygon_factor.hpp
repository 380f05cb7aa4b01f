#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace dlo::energy_model {

/// H = A + B B^T + shift, A symmetric and banded, B of few columns, factored in O(rows): L D L^T of
/// A + shift by GSL, and S = 1 + B^T (A + shift)^-1 B. The border
///     [ A + shift  B ]
///     [ B^T       -1 ]
/// has a negative eigenvalue for each column of B besides those of H, and besides those of A +
/// shift those of -S (Haynsworth).
class PolygonFactor {
 public:
  /// @param band  lower half of A, A(j + d, j) in row d and column j; at most as many rows as
  ///              columns
  /// @param B     rows x 0 where there is none
  /// @return whether H is positive definite
  bool compute(const Eigen::MatrixXd& band, const Eigen::MatrixXd& B, double shift);
  /// H^-1 of a vector.
  [[nodiscard]] Eigen::VectorXd solve(Eigen::VectorXd right);

 private:
  void solve_banded(Eigen::Ref<Eigen::VectorXd> vector);

  Eigen::MatrixXd factor_;  // D in the first row, L below
  Eigen::MatrixXd B_;
  Eigen::MatrixXd carried_;  // (A + shift)^-1 B
  Eigen::PartialPivLU<Eigen::MatrixXd> small_;
};

}  // namespace dlo::energy_model
