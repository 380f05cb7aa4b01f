#pragma once

#include <Eigen/Core>

#include "linear/dense_kernel.hpp"

namespace dlo::energy_model {

using DenseOperand = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using DenseResult = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// Of a matrix or a block with columns one after the other in memory.
template <typename Derived>
ConstColumns columns_of(const Eigen::MatrixBase<Derived>& m) {
  static_assert(!Derived::IsRowMajor && (Derived::Flags & Eigen::DirectAccessBit) != 0);
  return {m.derived().data(), m.rows(), m.cols(), m.derived().outerStride()};
}
/// The same to write to.
template <typename Derived>
Columns result_columns(Eigen::MatrixBase<Derived>& m) {
  static_assert(!Derived::IsRowMajor && (Derived::Flags & Eigen::DirectAccessBit) != 0);
  return {m.derived().data(), m.rows(), m.cols(), m.derived().outerStride()};
}

/// result = A B; result may not be one of the operands, here and below.
inline void multiply(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply(columns_of(a), columns_of(b), result_columns(result));
}

/// result = A B^T that is known to be symmetric
inline void multiply_symmetric(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply_symmetric(columns_of(a), columns_of(b), result_columns(result));
}

}  // namespace dlo::energy_model
