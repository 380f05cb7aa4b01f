#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dlo::force_model {

/// Symmetric matrix of 3 x 3 blocks, with one row of blocks per point and a block for each pair of
/// points that are at most two apart, as Stiffness in stiffness_terms.hpp requires. Only the
/// constructor allocates.
class BandMatrix {
 public:
  explicit BandMatrix(Eigen::Index points);

  void set_zero();
  /// Adds to the blocks (i, j) and, transposed, (j, i), i <= j <= i + 2. A block that is not
  /// finite, as at a joint that is folded back on itself, is ignored, because its stiffness is
  /// unknown.
  void add(Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& block);
  void add_to_diagonal(Eigen::Index i, double value);

  [[nodiscard]] Eigen::Index points() const { return static_cast<Eigen::Index>(rows_.size()); }
  /// Returns block (i, i + k), 0 <= k <= 2.
  [[nodiscard]] const Eigen::Matrix3d& block(Eigen::Index i, Eigen::Index k) const {
    return rows_[static_cast<std::size_t>(i)].block[k];
  }
  /// Multiplies the matrix by the vectors of all points. @param[out] result  3 x points
  void multiply(const Eigen::Matrix3Xd& vectors, Eigen::Matrix3Xd& result) const;

 private:
  struct Row {
    Eigen::Matrix3d block[3];
  };
  std::vector<Row> rows_;
};

/// Block L D L^T factorisation of a band matrix plus a multiple of the identity, restricted to the
/// free points. Only the constructor allocates.
class BandFactor {
 public:
  explicit BandFactor(Eigen::Index points);

  /// Factorises the matrix. @param is_free  1 for each free point; @return whether it is positive
  /// definite; if not, solve() must not be called
  [[nodiscard]] bool compute(const BandMatrix& matrix, const std::vector<char>& is_free,
                             double shift);
  /// Solves for the free points. @param[in,out] vectors  right-hand side, then the solution; 0 for
  /// held points
  void solve(Eigen::Matrix3Xd& vectors) const;

 private:
  struct Row {
    Eigen::Matrix3d inverse;   // inverse of the pivot
    Eigen::Matrix3d lower[2];  // (i + 1, i), (i + 2, i) of L
  };
  std::vector<Row> rows_;
};

}  // namespace dlo::force_model
