#pragma once

#include <cstddef>

namespace dlo::energy_model {

/// A matrix as Eigen stores it: column by column, each `stride` behind the one before.
struct ConstColumns {
  const double* data;
  std::ptrdiff_t rows, columns, stride;
};
struct Columns {
  double* data;
  std::ptrdiff_t rows, columns, stride;
};

/// Products of matrices of some ten to two hundred rows, for which a library's packing of its
/// operands costs as much as the product; `result` has its size and none of the operands' memory.
struct DenseKernel {
  void (*multiply)(ConstColumns a, ConstColumns b, Columns result);             ///< A B
  void (*multiply_transposed)(ConstColumns a, ConstColumns b, Columns result);  ///< A^T B
  /// A^T B that is symmetric, of which one half is worked out.
  void (*multiply_symmetric)(ConstColumns a, ConstColumns b, Columns result);
};

/// The one for this machine's instruction set.
[[nodiscard]] const DenseKernel& dense_kernel();

}  // namespace dlo::energy_model
