#include "strain/dense_kernel.hpp"

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

void multiply(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
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

void multiply_transposed(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
  constexpr std::ptrdiff_t width = 3;
  if (b.columns == 1) return multiply_transposed_strip<1>(a, b, result, 0, 0);
  if (b.columns == 2) return multiply_transposed_strip<2>(a, b, result, 0, 0);
  for (std::ptrdiff_t j = 0; j < b.columns; j += width) {
    multiply_transposed_strip<width>(a, b, result, 0, smaller(j, b.columns - width));
  }
}

void multiply_symmetric(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
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

/// One row after the other, or as many as a register has lanes.
inline void read(const double* from, double& value) { value = *from; }
inline void read(const double* from, Lanes& value) { value = read_lanes(from); }
inline void write(double* to, double value) { *to = value; }
inline void write(double* to, Lanes value) { write_lanes(to, value); }
inline double root(double a) { return __builtin_sqrt(a); }
inline Lanes root(Lanes a) {
  Lanes result{};
  for (std::ptrdiff_t i = 0; i < lane_count; ++i) result[i] = __builtin_sqrt(a[i]);
  return result;
}

template <typename Real>
struct Quaternion {
  Real w, x, y, z;
};

template <typename Real, typename Matrix>
inline Quaternion<Real> read_quaternion(const Matrix& from, std::ptrdiff_t row) {
  Quaternion<Real> q;
  read(from.data + row, q.w);
  read(from.data + from.stride + row, q.x);
  read(from.data + 2 * from.stride + row, q.y);
  read(from.data + 3 * from.stride + row, q.z);
  return q;
}

template <typename Real>
inline void write_quaternion(const Columns& to, std::ptrdiff_t row, const Quaternion<Real>& q) {
  write(to.data + row, q.w);
  write(to.data + to.stride + row, q.x);
  write(to.data + 2 * to.stride + row, q.y);
  write(to.data + 3 * to.stride + row, q.z);
}

template <typename Real>
inline void strains_row(const ConstColumns& q, const ConstColumns& u, double scale,
                        const Columns& result, std::ptrdiff_t row) {
  const Quaternion<Real> from = read_quaternion<Real>(q, row);
  Real a, b;
  read(u.data + row, a);
  read(u.data + u.stride + row, b);
  a = a * scale;
  b = b * scale;
  write_quaternion<Real>(result, row,
                         {-from.x * a - from.y * b, from.w * a - from.z * b,
                          from.w * b + from.z * a, from.x * b - from.y * a});
}

template <typename Real>
inline void conjugate_row(const Columns& a, const ConstColumns& b, std::ptrdiff_t row) {
  const Quaternion<Real> p = read_quaternion<Real>(a, row);
  const Quaternion<Real> q = read_quaternion<Real>(b, row);
  write_quaternion<Real>(a, row,
                         {p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z,
                          -p.w * q.x + p.x * q.w - p.y * q.z + p.z * q.y,
                          -p.w * q.y + p.y * q.w - p.z * q.x + p.x * q.z,
                          -p.w * q.z + p.z * q.w - p.x * q.y + p.y * q.x});
}

template <typename Real>
inline void add_row(const Columns& q, const ConstColumns& a, std::ptrdiff_t row) {
  const Quaternion<Real> p = read_quaternion<Real>(q, row);
  Quaternion<Real> by = read_quaternion<Real>(a, row);
  by.w = by.w + 1.0;
  const Quaternion<Real> sum = {by.w * p.w - by.x * p.x - by.y * p.y - by.z * p.z,
                                by.w * p.x + by.x * p.w + by.y * p.z - by.z * p.y,
                                by.w * p.y + by.y * p.w + by.z * p.x - by.x * p.z,
                                by.w * p.z + by.z * p.w + by.x * p.y - by.y * p.x};
  const Real size = root(sum.w * sum.w + sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
  write_quaternion<Real>(q, row, {sum.w / size, sum.x / size, sum.y / size, sum.z / size});
}

void multiply_by_two_strains(const ConstColumns& q, const ConstColumns& u, double scale,
                             const Columns& result) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= q.rows; r += lane_count) strains_row<Lanes>(q, u, scale, result, r);
  for (; r < q.rows; ++r) strains_row<double>(q, u, scale, result, r);
}

void multiply_by_conjugate(const Columns& a, const ConstColumns& b) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= a.rows; r += lane_count) conjugate_row<Lanes>(a, b, r);
  for (; r < a.rows; ++r) conjugate_row<double>(a, b, r);
}

void add_product(const Columns& q, const ConstColumns& a) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= q.rows; r += lane_count) add_row<Lanes>(q, a, r);
  for (; r < q.rows; ++r) add_row<double>(q, a, r);
}

}  // namespace

const DenseKernel& dense_kernel() {
  static constexpr DenseKernel kernel = {multiply,
                                         multiply_transposed,
                                         multiply_symmetric,
                                         multiply_by_two_strains,
                                         multiply_by_conjugate,
                                         add_product};
  return kernel;
}

}  // namespace dlo::energy_model::DLO_KERNEL
