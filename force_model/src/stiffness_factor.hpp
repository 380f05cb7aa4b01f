#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace dlo::force_model {

/// A symmetric matrix K = A + B B^T of a banded A and few full columns B: those of energies that
/// depend on a number of the whole shape, as twist does.
struct BorderedMatrix {
  Eigen::SparseMatrix<double> A;
  Eigen::MatrixXd B;  ///< A.rows() x 0 where there are none

  [[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& vectors) const;
  /// K plus a multiple of the identity.
  [[nodiscard]] BorderedMatrix shifted(double shift) const;
  /// Bound of the largest eigenvalue (Gershgorin, and |B|^2).
  [[nodiscard]] double largest_eigenvalue() const;
};

/// L D L^T of a bordered matrix in O(rows): of
///     [ A    B ]
///     [ B^T -1 ]
/// whose Schur complement with regard to -1 is K. By Haynsworth it has as many negative pivots as K
/// has negative eigenvalues, and one more for each column of B (Sylvester).
class StiffnessFactor {
 public:
  explicit StiffnessFactor(const BorderedMatrix& K);
  /// Of another matrix.
  void compute(const BorderedMatrix& K);

  /// Whether no pivot was zero.
  [[nodiscard]] bool succeeded() const { return factor_.info() == Eigen::Success; }
  /// Whether K is positive definite.
  [[nodiscard]] bool is_positive() const;
  /// K^-1 of each column.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// A direction d of negative curvature, d^T K d < 0; empty if there is none.
  [[nodiscard]] Eigen::VectorXd negative_curvature(const BorderedMatrix& K) const;

 private:
  Eigen::Index columns_ = 0;  // of B
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factor_;
};

/// The smallest eigenvalues of K and their modes, by subspace iteration with a factor of K, or of K
/// plus a shift of rounding size: from above, and within some percent.
struct SlowModes {
  static constexpr Eigen::Index most = 3;
  Eigen::Vector3d eigenvalues = Eigen::Vector3d::Zero();  ///< ascending
  Eigen::MatrixX3d modes;                                 ///< orthonormal, one a column
};

[[nodiscard]] SlowModes slow_modes(const BorderedMatrix& K, const StiffnessFactor& factor);

}  // namespace dlo::force_model
