#include "base/dense_kernel.hpp"

// Compiled once for each instruction set, DLO_KERNEL naming the namespace (see CMakeLists.txt).
// Nothing inline from a library that another file might compile too may be used in here but what
// the compiler is sure to inline: of such a function the linker keeps one copy, perhaps one with
// instructions that the machine lacks.

namespace dlo::energy_model::DLO_KERNEL {
namespace {

#if defined(__AVX2__)
constexpr std::ptrdiff_t lane_count = 4;
#else
constexpr std::ptrdiff_t lane_count = 2;
#endif

/// A register, and one as stored at any double (GCC and Clang vector extension).
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;
using StoredLanes [[gnu::vector_size(lane_count * sizeof(double)), gnu::aligned(sizeof(double)),
                    gnu::may_alias]] = double;

inline Lanes read_lanes(const double* from) { return *reinterpret_cast<const StoredLanes*>(from); }
inline void write_lanes(double* to, Lanes value) { *reinterpret_cast<StoredLanes*>(to) = value; }
inline std::ptrdiff_t smaller(std::ptrdiff_t a, std::ptrdiff_t b) { return a < b ? a : b; }

/// `registers` of rows from row i on, and `width` columns from column j on, of A B.
template <int registers, int width>
inline void multiply_tile(const ConstColumns& a, const ConstColumns& b, const Columns& result,
                          std::ptrdiff_t i, std::ptrdiff_t j) {
  Lanes sums[registers][width] = {};
  const double* left = a.data + i;
  const double* right = b.data + j * b.stride;
  for (std::ptrdiff_t k = 0; k < a.columns; ++k, left += a.stride, ++right) {
    Lanes column[registers];
    for (int r = 0; r < registers; ++r) column[r] = read_lanes(left + r * lane_count);
    for (int c = 0; c < width; ++c) {
      const double factor = right[c * b.stride];
      for (int r = 0; r < registers; ++r) sums[r][c] += column[r] * factor;
    }
  }
  for (int c = 0; c < width; ++c) {
    double* to = result.data + (j + c) * result.stride + i;
    for (int r = 0; r < registers; ++r) write_lanes(to + r * lane_count, sums[r][c]);
  }
}

/// `width` columns of A B from column j on. The last rows are worked out with as many before them
/// as fill a tile.
template <int width>
inline void multiply_strip(const ConstColumns& a, const ConstColumns& b, const Columns& result,
                           std::ptrdiff_t j) {
  constexpr int registers = 2;
  constexpr std::ptrdiff_t tall = registers * lane_count;
  if (a.rows >= tall) {
    for (std::ptrdiff_t i = 0; i < a.rows; i += tall) {
      multiply_tile<registers, width>(a, b, result, smaller(i, a.rows - tall), j);
    }
    return;
  }
  if (a.rows >= lane_count) {
    for (std::ptrdiff_t i = 0; i < a.rows; i += lane_count) {
      multiply_tile<1, width>(a, b, result, smaller(i, a.rows - lane_count), j);
    }
    return;
  }
  for (std::ptrdiff_t c = j; c < j + width; ++c) {
    for (std::ptrdiff_t i = 0; i < a.rows; ++i) {
      double sum = 0;
      for (std::ptrdiff_t k = 0; k < a.columns; ++k) {
        sum += a.data[k * a.stride + i] * b.data[c * b.stride + k];
      }
      result.data[c * result.stride + i] = sum;
    }
  }
}

void multiply(ConstColumns a, ConstColumns b, Columns result) {
  constexpr std::ptrdiff_t width = 4;
  if (b.columns >= width) {
    for (std::ptrdiff_t j = 0; j < b.columns; j += width) {
      multiply_strip<width>(a, b, result, smaller(j, b.columns - width));
    }
    return;
  }
  if (b.columns == 3) multiply_strip<3>(a, b, result, 0);
  if (b.columns == 2) multiply_strip<2>(a, b, result, 0);
  if (b.columns == 1) multiply_strip<1>(a, b, result, 0);
}

/// What keeps the last `rest` lanes.
inline Lanes last_lanes(std::ptrdiff_t rest) {
  Lanes kept{};
  for (std::ptrdiff_t i = 0; i < lane_count; ++i) kept[i] = i >= lane_count - rest ? 1 : 0;
  return kept;
}

/// The sums of the lanes of four registers, one after the other, to memory.
inline void write_sums(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, double* to) {
#if defined(__AVX2__)
  const Lanes ab =
      __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd =
      __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  write_lanes(to, __builtin_shufflevector(ab, cd, 0, 1, 4, 5) +
                      __builtin_shufflevector(ab, cd, 2, 3, 6, 7));
#else
  write_lanes(to, __builtin_shufflevector(a, b, 0, 2) + __builtin_shufflevector(a, b, 1, 3));
  write_lanes(to + lane_count,
              __builtin_shufflevector(c, d, 0, 2) + __builtin_shufflevector(c, d, 1, 3));
#endif
}

/// Four rows from row i on and `width` columns from column j on of A^T B, of as many rows as a
/// register has lanes at least.
template <int width>
inline void multiply_transposed_tile(const ConstColumns& a, const ConstColumns& b,
                                     const Columns& result, std::ptrdiff_t i, std::ptrdiff_t j) {
  Lanes sums[4][width] = {};
  const double* left = a.data + i * a.stride;
  const double* right = b.data + j * b.stride;
  std::ptrdiff_t k = 0;
  for (; k + lane_count <= a.rows; k += lane_count) {
    Lanes factors[width];
    for (int c = 0; c < width; ++c) factors[c] = read_lanes(right + c * b.stride + k);
    for (int r = 0; r < 4; ++r) {
      const Lanes column = read_lanes(left + r * a.stride + k);
      for (int c = 0; c < width; ++c) sums[r][c] += column * factors[c];
    }
  }
  if (k < a.rows) {
    const Lanes kept = last_lanes(a.rows - k);
    k = a.rows - lane_count;
    for (int c = 0; c < width; ++c) {
      const Lanes factor = kept * read_lanes(right + c * b.stride + k);
      for (int r = 0; r < 4; ++r) sums[r][c] += read_lanes(left + r * a.stride + k) * factor;
    }
  }
  for (int c = 0; c < width; ++c) {
    write_sums(sums[0][c], sums[1][c], sums[2][c], sums[3][c],
               result.data + (j + c) * result.stride + i);
  }
}

inline double dot(const double* a, const double* b, std::ptrdiff_t size) {
  double sum = 0;
  for (std::ptrdiff_t k = 0; k < size; ++k) sum += a[k] * b[k];
  return sum;
}

/// Rows from `first` on of `width` columns of A^T B.
template <int width>
inline void multiply_transposed_strip(const ConstColumns& a, const ConstColumns& b,
                                      const Columns& result, std::ptrdiff_t first,
                                      std::ptrdiff_t j) {
  if (a.columns >= 4 && a.rows >= lane_count) {
    for (std::ptrdiff_t i = first; i < a.columns; i += 4) {
      multiply_transposed_tile<width>(a, b, result, smaller(i, a.columns - 4), j);
    }
    return;
  }
  for (std::ptrdiff_t c = j; c < j + width; ++c) {
    for (std::ptrdiff_t i = first; i < a.columns; ++i) {
      result.data[c * result.stride + i] =
          dot(a.data + i * a.stride, b.data + c * b.stride, a.rows);
    }
  }
}

void multiply_transposed(ConstColumns a, ConstColumns b, Columns result) {
  constexpr std::ptrdiff_t width = 3;
  if (b.columns == 1) return multiply_transposed_strip<1>(a, b, result, 0, 0);
  if (b.columns == 2) return multiply_transposed_strip<2>(a, b, result, 0, 0);
  for (std::ptrdiff_t j = 0; j < b.columns; j += width) {
    multiply_transposed_strip<width>(a, b, result, 0, smaller(j, b.columns - width));
  }
}

void multiply_symmetric(ConstColumns a, ConstColumns b, Columns result) {
  constexpr std::ptrdiff_t width = 3;
  if (b.columns < width) return multiply_transposed(a, b, result);
  for (std::ptrdiff_t j = 0; j < b.columns; j += width) {
    const std::ptrdiff_t column = smaller(j, b.columns - width);
    multiply_transposed_strip<width>(a, b, result, column, column);
  }
  for (std::ptrdiff_t j = 0; j < b.columns; ++j) {
    for (std::ptrdiff_t i = j + 1; i < b.columns; ++i) {
      result.data[i * result.stride + j] = result.data[j * result.stride + i];
    }
  }
}

}  // namespace

const DenseKernel& dense_kernel() {
  static constexpr DenseKernel kernel = {multiply, multiply_transposed, multiply_symmetric};
  return kernel;
}

}  // namespace dlo::energy_model::DLO_KERNEL
