#include "band_matrix.hpp"

#include <Eigen/LU>
#include <cmath>

namespace dlo::force_model {
namespace {

/// Inverts a symmetric block. @return whether it is positive definite by more than rounding, by its
/// leading minors
bool invert(const Eigen::Matrix3d& block, Eigen::Matrix3d& inverse) {
  // Fraction of a diagonal element below which its pivot consists of rounding errors only.
  constexpr double rounding = 1e-14;
  const double a = block(0, 0);
  if (!(a > 0)) return false;
  const double b = block(1, 1) - block(1, 0) * block(1, 0) / a;
  if (!(b > rounding * block(1, 1))) return false;
  const double mixed = block(2, 1) - block(2, 0) * block(1, 0) / a;
  const double c = block(2, 2) - block(2, 0) * block(2, 0) / a - mixed * mixed / b;
  if (!(c > rounding * block(2, 2)) || !std::isfinite(c)) return false;
  // Rows of the inverse of the unit lower factor.
  const double l10 = block(1, 0) / a;
  const double l21 = mixed / b;
  const double m20 = l10 * l21 - block(2, 0) / a;
  inverse(0, 0) = 1 / a + l10 * l10 / b + m20 * m20 / c;
  inverse(1, 0) = inverse(0, 1) = -l10 / b - m20 * l21 / c;
  inverse(2, 0) = inverse(0, 2) = m20 / c;
  inverse(1, 1) = 1 / b + l21 * l21 / c;
  inverse(2, 1) = inverse(1, 2) = -l21 / c;
  inverse(2, 2) = 1 / c;
  return true;
}

}  // namespace

BandMatrix::BandMatrix(Eigen::Index points) : rows_(static_cast<std::size_t>(points)) {
  set_zero();
}

void BandMatrix::set_zero() {
  for (Row& row : rows_) {
    for (Eigen::Matrix3d& block : row.block) block.setZero();
  }
}

void BandMatrix::add(Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& block) {
  if (!std::isfinite(block.sum())) return;
  rows_[static_cast<std::size_t>(i)].block[j - i] += block;
}

void BandMatrix::add_to_diagonal(Eigen::Index i, double value) {
  rows_[static_cast<std::size_t>(i)].block[0].diagonal().array() += value;
}

void BandMatrix::multiply(const Eigen::Matrix3Xd& vectors, Eigen::Matrix3Xd& result) const {
  result.setZero();
  const Eigen::Index count = points();
  for (Eigen::Index i = 0; i < count; ++i) {
    result.col(i) += block(i, 0) * vectors.col(i);
    for (Eigen::Index k = 1; k <= 2 && i + k < count; ++k) {
      result.col(i) += block(i, k) * vectors.col(i + k);
      result.col(i + k) += block(i, k).transpose() * vectors.col(i);
    }
  }
}

BandFactor::BandFactor(Eigen::Index points) : rows_(static_cast<std::size_t>(points)) {}

bool BandFactor::compute(const BandMatrix& matrix, const std::vector<char>& is_free, double shift) {
  // Changes by the elimination of the previous points (terms of the Schur complement): of this
  // point's diagonal block, of the next one's, and of the block between both.
  const Eigen::Index count = matrix.points();
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d next = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d between = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < count; ++i) {
    Row& row = rows_[static_cast<std::size_t>(i)];
    const auto free_at = [&](Eigen::Index k) {
      return i + k < count && is_free[static_cast<std::size_t>(i + k)] != 0;
    };
    if (!free_at(0)) {
      row.inverse.setZero();
      row.lower[0].setZero();
      row.lower[1].setZero();
      own = next;
      next.setZero();
      between.setZero();
      continue;
    }
    Eigen::Matrix3d pivot = matrix.block(i, 0) + own;
    pivot.diagonal().array() += shift;
    if (!invert(pivot, row.inverse)) return false;
    Eigen::Matrix3d upper_1 = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d upper_2 = Eigen::Matrix3d::Zero();
    if (free_at(1)) upper_1 = matrix.block(i, 1) + between;
    if (free_at(2)) upper_2 = matrix.block(i, 2);
    row.lower[0].noalias() = upper_1.transpose() * row.inverse;
    row.lower[1].noalias() = upper_2.transpose() * row.inverse;
    own = next;
    own.noalias() -= row.lower[0] * upper_1;
    next.noalias() = -(row.lower[1] * upper_2);
    between.noalias() = -(row.lower[0] * upper_2);
  }
  return true;
}

void BandFactor::solve(Eigen::Matrix3Xd& vectors) const {
  const Eigen::Index count = vectors.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d here = vectors.col(i);
    for (Eigen::Index k = 1; k <= 2 && i + k < count; ++k) {
      vectors.col(i + k) -= row.lower[k - 1] * here;
    }
    vectors.col(i) = row.inverse * here;
  }
  for (Eigen::Index i = count - 1; i >= 0; --i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 1; k <= 2 && i + k < count; ++k) {
      vectors.col(i) -= row.lower[k - 1].transpose() * vectors.col(i + k);
    }
  }
}

}  // namespace dlo::force_model
