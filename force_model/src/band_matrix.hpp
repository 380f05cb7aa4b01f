#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dlo::force_model {

/// A symmetric matrix of 3 x 3 blocks, one row of blocks a point, with a block for each pair of
/// points that are at most two apart: what Stiffness of stiffness_terms.hpp asks for. Only the
/// constructor allocates.
class BandMatrix {
 public:
  explicit BandMatrix(Eigen::Index points);

  void set_zero();
  /// Adds to the blocks (i, j) and, transposed, (j, i), i <= j <= i + 2. What is not finite, as at
  /// a joint that is folded back on itself, is left out: no stiffness is known there.
  void add(Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& block);
  /// Adds to the diagonal of a point.
  void add_to_diagonal(Eigen::Index i, double value);

  [[nodiscard]] Eigen::Index points() const { return static_cast<Eigen::Index>(rows_.size()); }
  /// Block (i, i + k), 0 <= k <= 2.
  [[nodiscard]] const Eigen::Matrix3d& block(Eigen::Index i, Eigen::Index k) const {
    return rows_[static_cast<std::size_t>(i)].block[k];
  }
  /// The matrix times vectors of all points. @param[out] result  3 x points
  void multiply(const Eigen::Matrix3Xd& vectors, Eigen::Matrix3Xd& result) const;

 private:
  struct Row {
    Eigen::Matrix3d block[3];
  };
  std::vector<Row> rows_;
};

/// L D L^T by blocks of a band matrix plus a multiple of the identity, over the points that are
/// free; held ones are left out. Only the constructor allocates.
class BandFactor {
 public:
  explicit BandFactor(Eigen::Index points);

  /// @param is_free  of each point; @return whether it is positive definite, else solve() may not
  /// be called
  [[nodiscard]] bool compute(const BandMatrix& matrix, const std::vector<char>& is_free,
                             double shift);
  /// @param[in,out] vectors  right side, then the solution; 0 of held points
  void solve(Eigen::Matrix3Xd& vectors) const;

 private:
  struct Row {
    Eigen::Matrix3d inverse;   // of the pivot
    Eigen::Matrix3d lower[2];  // (i + 1, i), (i + 2, i) of L
  };
  std::vector<Row> rows_;
};

}  // namespace dlo::force_model
