#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace dlo::force_model {

/// Symmetric matrix K = A + B B^T with a banded A and a few full columns B, one for each energy
/// that depends on a number of the whole shape, such as twist.
struct BorderedMatrix {
  Eigen::SparseMatrix<double> A;
  Eigen::MatrixXd B;  ///< A.rows() x 0 if there are none

  [[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& vectors) const;
  /// Returns K plus a multiple of the identity.
  [[nodiscard]] BorderedMatrix shifted(double shift) const;
  /// Returns a bound of the largest eigenvalue (Gershgorin, and |B|^2).
  [[nodiscard]] double eigenvalue_bound() const;
};

/// L D L^T factorisation of a bordered matrix in O(rows), computed from
///     [ A    B ]
///     [ B^T -1 ]
/// whose Schur complement with respect to -1 is K. It has as many negative pivots as K has negative
/// eigenvalues (Haynsworth), plus one for each column of B (Sylvester).
class StiffnessFactor {
 public:
  explicit StiffnessFactor(const BorderedMatrix& K);
  /// Replaces the factorisation by that of another matrix.
  void compute(const BorderedMatrix& K);

  /// Whether no pivot was zero.
  [[nodiscard]] bool succeeded() const { return factor_.info() == Eigen::Success; }
  /// Whether K is positive definite.
  [[nodiscard]] bool is_positive() const;
  /// Returns K^-1 times each column.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// Returns a direction d of negative curvature, d^T K d < 0; empty if there is none. If K has
  /// columns B, K must not be positive definite, and d is an estimate of its lowest mode.
  [[nodiscard]] Eigen::VectorXd negative_curvature(const BorderedMatrix& K) const;

 private:
  Eigen::Index columns_ = 0;  // number of columns of B
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factor_;
};

/// Smallest eigenvalues of K and their modes, by subspace iteration with a factorisation of K, or
/// of K plus a shift of the size of rounding. The eigenvalues are upper bounds, accurate to a few
/// percent.
struct SlowModes {
  static constexpr Eigen::Index most = 3;
  Eigen::Vector3d eigenvalues = Eigen::Vector3d::Zero();  ///< ascending
  Eigen::MatrixX3d modes;                                 ///< orthonormal columns
};

[[nodiscard]] SlowModes slow_modes(const BorderedMatrix& K, const StiffnessFactor& factor);

}  // namespace dlo::force_model
