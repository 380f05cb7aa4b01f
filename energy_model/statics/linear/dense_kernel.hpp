#pragma once

#include <cstddef>
#include <string_view>

namespace dlo::energy_model {

/// A matrix in Eigen's column-major storage: consecutive columns begin `stride` numbers apart.
struct ConstColumns {
  const double* data;
  std::ptrdiff_t rows, columns, stride;
};
struct Columns {
  double* data;
  std::ptrdiff_t rows, columns, stride;
};

/// The elementwise product weights o (left right^T); `left` and `right` have three columns.
struct WeightedProduct {
  ConstColumns weights, left, right;
};

/// Number of doubles in the widest vector register, to a multiple of which strides are padded.
inline constexpr std::ptrdiff_t padding = 8;

/// Products of matrices of about ten to two hundred rows, for which a library's packing of the
/// operands costs as much as the product; Cholesky factors of such matrices; sines; and products of
/// quaternions, one per row in the order w, x, y, z. Each result has its final size before the call
/// and shares no memory with an operand.
struct DenseKernel {
  void (*multiply)(const ConstColumns& a, const ConstColumns& b, const Columns& result);  ///< A B
  /// Computes A B^T, which has to be symmetric: only one half is computed, the other is copied.
  void (*multiply_symmetric)(const ConstColumns& a, const ConstColumns& b, const Columns& result);
  /// Computes scale q (0, u1, u2, 0).
  void (*multiply_by_two_strains)(const ConstColumns& q, const ConstColumns& u, double scale,
                                  const Columns& result);
  void (*multiply_by_conjugate)(const Columns& a, const ConstColumns& b);  ///< a = a conj(b)
  void (*add_product)(const Columns& q, const ConstColumns& a);  ///< q = q + a q, normalised
  /// Factors a symmetric A = L L^T in place. Reads the lower half of A and writes L, with the
  /// inverse of each diagonal element in its place. The stride has to be a multiple of `padding`;
  /// elements above the diagonal and between the last row and the stride are overwritten.
  /// @return whether A is positive definite
  bool (*factor)(const Columns& a);
  /// Replaces x by (L L^T)^-1 x, with L from factor().
  void (*solve)(const ConstColumns& l, double* x);
  /// Replaces a symmetric A by P A P, with the reflection P = 1 - tau v v^T.
  /// @param w  scratch, one number per row
  void (*reflect)(const Columns& a, const double* v, double tau, double* w);
  /// Computes cosines and sines of `count` angles [rad], accurate to 2e-16 for angles up to 1e6.
  void (*turn)(const double* angles, std::ptrdiff_t count, double* cosines, double* sines);
  /// Computes a + b.
  void (*add_weighted_products)(const WeightedProduct& a, const WeightedProduct& b,
                                const Columns& result);
};

/// Returns the kernel for an instruction set: "baseline", "avx2" or "avx512".
/// @throws std::invalid_argument naming the value and the sets that this machine has
[[nodiscard]] const DenseKernel& dense_kernel_named(std::string_view name);

/// Returns the kernel for the fastest instruction set of this machine. For tests and comparisons of
/// machines the environment variable DLO_INSTRUCTION_SET selects another one; it is read once, and
/// an empty value counts as not set.
/// @throws std::invalid_argument as dense_kernel_named
[[nodiscard]] const DenseKernel& dense_kernel();

}  // namespace dlo::energy_model
