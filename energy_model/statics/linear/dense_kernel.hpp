#pragma once

#include <cstddef>
#include <string_view>

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

/// weights o (left right^T), element by element; `left` and `right` have three columns.
struct WeighedProduct {
  ConstColumns weights, left, right;
};

/// The widest register has as many lanes.
inline constexpr std::ptrdiff_t padding = 8;

/// Products of matrices of some ten to two hundred rows, for which a library's packing of its
/// operands costs as much as the product, factors of such, sines, and products of quaternions, one
/// a row: w, x, y, z. Results have their size and none of the operands' memory.
struct DenseKernel {
  void (*multiply)(const ConstColumns& a, const ConstColumns& b, const Columns& result);  ///< A B
  /// A B^T that is symmetric, of which one half is worked out.
  void (*multiply_symmetric)(const ConstColumns& a, const ConstColumns& b, const Columns& result);
  /// scale q (0, u1, u2, 0)
  void (*multiply_by_two_strains)(const ConstColumns& q, const ConstColumns& u, double scale,
                                  const Columns& result);
  void (*multiply_by_conjugate)(const Columns& a, const ConstColumns& b);  ///< a = a conj(b)
  void (*add_product)(const Columns& q, const ConstColumns& a);  ///< q = q + a q, of length 1 again
  /// Lower half of a symmetric A = L L^T to L with one over each element of its diagonal; the
  /// stride is a multiple of `padding`, and what a column has beyond its rows, and above the
  /// diagonal, is written too. @return whether A is positive definite
  bool (*factor)(const Columns& a);
  /// x to (L L^T)^-1 x, of such a factor.
  void (*solve)(const ConstColumns& l, double* x);
  /// A = P A P of a symmetric A with the reflection P = 1 - tau v v^T.
  /// @param w  scratch, as many as rows
  void (*reflect)(const Columns& a, const double* v, double tau, double* w);
  /// Cosines and sines of as many angles [rad], right to 2e-16 up to 1e6.
  void (*turn)(const double* angles, std::ptrdiff_t count, double* cosines, double* sines);
  /// a + b
  void (*add_weighed)(const WeighedProduct& a, const WeighedProduct& b, const Columns& result);
};

/// The one for an instruction set: "baseline", "avx2" or "avx512".
/// @throws std::invalid_argument naming the value and the sets that this machine has
[[nodiscard]] const DenseKernel& dense_kernel_named(std::string_view name);

/// The one for this machine's fastest instruction set or, for tests and to compare machines, for
/// the one that the environment variable DLO_INSTRUCTION_SET names, which is read once; empty, it
/// counts as not set.
/// @throws std::invalid_argument as dense_kernel_named
[[nodiscard]] const DenseKernel& dense_kernel();

}  // namespace dlo::energy_model
