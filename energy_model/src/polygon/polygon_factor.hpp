#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace dlo::energy_model {

/// L D L^T of H = A + B B^T + shift, A banded and B of few columns, in O(rows): the border
///     [ A + shift  B ]
///     [ B^T       -1 ]
/// has a negative eigenvalue for each column of B, and besides those of H (Haynsworth).
class PolygonFactor {
 public:
  using Sparse = Eigen::SparseMatrix<double>;

  /// @param A  lower half;  @param B  rows x 0 where there is none
  /// @return whether H is positive definite
  bool compute(const Sparse& A, const Eigen::MatrixXd& B, double shift);
  /// H^-1 of a vector.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  Eigen::Index columns_ = 0;
  Sparse bordered_;
  Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>> solver_;
};

}  // namespace dlo::energy_model
