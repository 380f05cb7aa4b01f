#pragma once

#include <Eigen/Core>

#include "linear/dense_kernel.hpp"

namespace dlo::energy_model {

using DenseOperand = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using DenseResult = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// Returns a view of a column-major matrix or block for DenseKernel.
template <typename Derived>
ConstColumns columns_of(const Eigen::MatrixBase<Derived>& m) {
  static_assert(!Derived::IsRowMajor && (Derived::Flags & Eigen::DirectAccessBit) != 0);
  return {m.derived().data(), m.rows(), m.cols(), m.derived().outerStride()};
}
/// Returns a writable view of a column-major matrix or block for DenseKernel.
template <typename Derived>
Columns result_columns(Eigen::MatrixBase<Derived>& m) {
  static_assert(!Derived::IsRowMajor && (Derived::Flags & Eigen::DirectAccessBit) != 0);
  return {m.derived().data(), m.rows(), m.cols(), m.derived().outerStride()};
}

/// Computes result = A B. Here and below, `result` must not be one of the operands.
inline void multiply(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply(columns_of(a), columns_of(b), result_columns(result));
}

/// Computes result = A B^T, which has to be symmetric.
inline void multiply_symmetric(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply_symmetric(columns_of(a), columns_of(b), result_columns(result));
}

}  // namespace dlo::energy_model
