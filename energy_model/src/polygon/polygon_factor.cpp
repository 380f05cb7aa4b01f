#include "polygon/polygon_factor.hpp"

#include <vector>

namespace dlo::energy_model {

bool PolygonFactor::compute(const Sparse& A, const Eigen::MatrixXd& B, double shift) {
  columns_ = B.cols();
  if (columns_ == 0) {
    solver_.setShift(shift);
    solver_.compute(A);
    return solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0;
  }
  const Eigen::Index rows = A.rows();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(A.nonZeros() + (rows + 1) * columns_ + rows));
  for (Eigen::Index j = 0; j < rows; ++j) {
    for (Sparse::InnerIterator entry(A, j); entry; ++entry) {
      entries.emplace_back(entry.row(), entry.col(), entry.value());
    }
    entries.emplace_back(j, j, shift);
  }
  for (Eigen::Index k = 0; k < columns_; ++k) {
    for (Eigen::Index i = 0; i < rows; ++i) entries.emplace_back(rows + k, i, B(i, k));
    entries.emplace_back(rows + k, rows + k, -1);
  }
  bordered_.resize(rows + columns_, rows + columns_);
  bordered_.setFromTriplets(entries.begin(), entries.end());
  solver_.setShift(0);
  solver_.compute(bordered_);
  if (solver_.info() != Eigen::Success) return false;
  const Eigen::VectorXd pivots = solver_.vectorD();
  return pivots.allFinite() && (pivots.array() > 0).count() == rows;
}

Eigen::VectorXd PolygonFactor::solve(const Eigen::VectorXd& right) const {
  if (columns_ == 0) return solver_.solve(right);
  Eigen::VectorXd bordered = Eigen::VectorXd::Zero(right.size() + columns_);
  bordered.head(right.size()) = right;
  return solver_.solve(bordered).head(right.size());
}

}  // namespace dlo::energy_model
