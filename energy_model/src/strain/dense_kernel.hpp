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
/// operands costs as much as the product, and of quaternions, one a row: w, x, y, z. Results have
/// their size and none of the operands' memory.
struct DenseKernel {
  void (*multiply)(const ConstColumns& a, const ConstColumns& b, const Columns& result);  ///< A B
  void (*multiply_transposed)(const ConstColumns& a, const ConstColumns& b,
                              const Columns& result);  ///< A^T B
  /// A^T B that is symmetric, of which one half is worked out.
  void (*multiply_symmetric)(const ConstColumns& a, const ConstColumns& b, const Columns& result);
  /// scale q (0, u1, u2, 0)
  void (*multiply_by_two_strains)(const ConstColumns& q, const ConstColumns& u, double scale,
                                  const Columns& result);
  void (*multiply_by_conjugate)(const Columns& a, const ConstColumns& b);  ///< a = a conj(b)
  void (*add_product)(const Columns& q, const ConstColumns& a);  ///< q = q + a q, of length 1 again
};

/// The one for this machine's instruction set.
[[nodiscard]] const DenseKernel& dense_kernel();

}  // namespace dlo::energy_model
