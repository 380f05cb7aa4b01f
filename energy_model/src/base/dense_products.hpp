#pragma once

#include <Eigen/Core>

#include "base/dense_kernel.hpp"

namespace dlo::energy_model {

using DenseOperand = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using DenseResult = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

inline ConstColumns columns_of(const DenseOperand& m) {
  return {m.data(), m.rows(), m.cols(), m.outerStride()};
}
inline Columns columns_of(DenseResult& m) {
  return {m.data(), m.rows(), m.cols(), m.outerStride()};
}

/// result = A B; result may not be one of the operands, here and below.
inline void multiply(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply(columns_of(a), columns_of(b), columns_of(result));
}

/// result = A^T B
inline void multiply_transposed(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply_transposed(columns_of(a), columns_of(b), columns_of(result));
}

/// result = A^T B that is known to be symmetric
inline void multiply_symmetric(const DenseOperand& a, const DenseOperand& b, DenseResult result) {
  dense_kernel().multiply_symmetric(columns_of(a), columns_of(b), columns_of(result));
}

}  // namespace dlo::energy_model
