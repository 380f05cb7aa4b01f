#include "stiffness_factor.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace dlo::force_model {
namespace {

/// Returns the matrix with its border; the upper part of the border is omitted.
Eigen::SparseMatrix<double> with_border(const BorderedMatrix& K) {
  const Eigen::Index rows = K.A.rows();
  const Eigen::Index columns = K.B.cols();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(K.A.nonZeros() + (rows + 1) * columns));
  for (Eigen::Index j = 0; j < rows; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(K.A, j); entry; ++entry) {
      entries.emplace_back(entry.row(), entry.col(), entry.value());
    }
  }
  for (Eigen::Index k = 0; k < columns; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) entries.emplace_back(rows + k, i, K.B(i, k));
    entries.emplace_back(rows + k, rows + k, -1);
  }
  Eigen::SparseMatrix<double> result(rows + columns, rows + columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Orthonormalises the columns by Gram-Schmidt, repeated once for nearly parallel columns.
void orthonormalise(Eigen::MatrixX3d& block) {
  for (Eigen::Index i = 0; i < SlowModes::most; ++i) {
    block.col(i).normalize();
    for (int turn = 0; turn < 2; ++turn) {
      for (Eigen::Index j = 0; j < i; ++j) {
        block.col(i) -= block.col(j).dot(block.col(i)) * block.col(j);
      }
      block.col(i).normalize();
    }
  }
}

}  // namespace

Eigen::MatrixXd BorderedMatrix::times(const Eigen::MatrixXd& vectors) const {
  Eigen::MatrixXd result = A * vectors;
  if (B.cols() > 0) result += B * (B.transpose() * vectors);
  return result;
}

BorderedMatrix BorderedMatrix::shifted(double shift) const {
  BorderedMatrix result = *this;
  for (Eigen::Index i = 0; i < A.rows(); ++i) result.A.coeffRef(i, i) += shift;
  return result;
}

double BorderedMatrix::eigenvalue_bound() const {
  return (Eigen::RowVectorXd::Ones(A.rows()) * A.cwiseAbs()).maxCoeff() + B.squaredNorm();
}

StiffnessFactor::StiffnessFactor(const BorderedMatrix& K) { compute(K); }

void StiffnessFactor::compute(const BorderedMatrix& K) {
  columns_ = K.B.cols();
  if (columns_ == 0) {
    factor_.compute(K.A);
  } else {
    factor_.compute(with_border(K));
  }
}

bool StiffnessFactor::is_positive() const {
  if (!succeeded()) return false;
  const Eigen::VectorXd pivots = factor_.vectorD();
  if (columns_ == 0) return pivots.minCoeff() > 0;
  return pivots.allFinite() && (pivots.array() > 0).count() == pivots.size() - columns_;
}

Eigen::MatrixXd StiffnessFactor::solve(const Eigen::MatrixXd& right) const {
  if (columns_ == 0) return factor_.solve(right);
  Eigen::MatrixXd bordered = Eigen::MatrixXd::Zero(right.rows() + columns_, right.cols());
  bordered.topRows(right.rows()) = right;
  return factor_.solve(bordered).topRows(right.rows());
}

Eigen::VectorXd StiffnessFactor::negative_curvature(const BorderedMatrix& K) const {
  if (columns_ == 0) {
    // With K = L D L^T and D_j < 0, the vector d with L^T d = e_j satisfies d^T K d = D_j. Of equal
    // pivots the first is used, so that an upright rod buckles in the plane of x.
    const Eigen::VectorXd pivots = factor_.vectorD();
    const double lowest = pivots.minCoeff();
    if (!(lowest < 0)) return {};
    Eigen::Index pivot = 0;
    while (!(pivots[pivot] <= 0.999 * lowest)) ++pivot;
    return factor_.matrixU().solve(Eigen::VectorXd::Unit(pivots.size(), pivot));
  }
  // The pivots of the bordered matrix do not give directions of K. The lowest mode is found by
  // inverse iteration with a shift: the first of eps 4^k largest, k = 0, 1, .., that makes K
  // positive definite.
  const double largest = K.eigenvalue_bound();
  for (double share = std::numeric_limits<double>::epsilon(); share < 2; share *= 4) {
    const BorderedMatrix shifted = K.shifted(share * largest);
    const StiffnessFactor factor(shifted);
    if (factor.is_positive()) return slow_modes(shifted, factor).modes.col(0);
  }
  return {};
}

SlowModes slow_modes(const BorderedMatrix& K, const StiffnessFactor& factor) {
  constexpr int iterations = 8;
  // Without any symmetry to which a mode could be orthogonal.
  Eigen::MatrixX3d block(K.A.rows(), 3);
  for (Eigen::Index i = 0; i < block.size(); ++i) {
    block.reshaped()[i] = std::sin(1 + 2.3999632 * static_cast<double>(i));
  }
  for (int i = 0; i < iterations; ++i) {
    orthonormalise(block);
    block = factor.solve(block);
  }
  orthonormalise(block);
  const Eigen::MatrixX3d K_block = K.times(block);
  const Eigen::Matrix3d projected = block.transpose() * K_block;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> ritz(projected);
  return {ritz.eigenvalues(), block * ritz.eigenvectors()};
}

}  // namespace dlo::force_model
