#include "linear/dense_kernel.hpp"

// This file is compiled once for each instruction set, and DLO_KERNEL names the namespace (see
// CMakeLists.txt). It must not call inline functions of a library that another file might compile
// too, unless the compiler certainly inlines them: the linker keeps one copy of such a function,
// possibly one with instructions that the machine lacks.

namespace dlo::energy_model::DLO_KERNEL {

// Registers

#if defined(__AVX512F__)
constexpr std::ptrdiff_t lane_count = 8;
#elif defined(__AVX2__)
constexpr std::ptrdiff_t lane_count = 4;
#else
constexpr std::ptrdiff_t lane_count = 2;
#endif

/// A vector register, and its form in memory at any address of a double (GCC and Clang vector
/// extension).
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;
using StoredLanes [[gnu::vector_size(lane_count * sizeof(double)), gnu::aligned(sizeof(double)),
                    gnu::may_alias]] = double;

inline Lanes read_lanes(const double* from) { return *reinterpret_cast<const StoredLanes*>(from); }
inline void write_lanes(double* to, Lanes value) { *reinterpret_cast<StoredLanes*>(to) = value; }
inline std::ptrdiff_t smaller(std::ptrdiff_t a, std::ptrdiff_t b) { return a < b ? a : b; }

inline void add_multiple(const double* from, double factor, std::ptrdiff_t size, double* to) {
  std::ptrdiff_t i = 0;
  for (; i + lane_count <= size; i += lane_count) {
    write_lanes(to + i, read_lanes(to + i) + read_lanes(from + i) * factor);
  }
  for (; i < size; ++i) to[i] += factor * from[i];
}

inline double dot(const double* a, const double* b, std::ptrdiff_t size) {
  Lanes sums{};
  std::ptrdiff_t i = 0;
  for (; i + lane_count <= size; i += lane_count) sums += read_lanes(a + i) * read_lanes(b + i);
  double sum = 0;
  for (; i < size; ++i) sum += a[i] * b[i];
  for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) sum += sums[lane];
  return sum;
}

// Products of matrices

/// Number of columns that are computed at once.
constexpr std::ptrdiff_t strip_width = 4;

/// Factors of the columns of A in a product: element k of column j of the right operand is stored
/// at data + k * next + j * beside.
struct Factors {
  const double* data;
  std::ptrdiff_t next, beside;
};

/// Computes a tile of the product A B, or subtracts it from the result. The tile begins at row i
/// and column j; it has `width` columns and as many rows as fit into `registers` vector registers.
template <int registers, int width, bool subtracts = false>
inline void multiply_tile(const ConstColumns& a, const Factors& b, const Columns& result,
                          std::ptrdiff_t i, std::ptrdiff_t j) {
  Lanes sums[registers][width] = {};
  const double* left = a.data + i;
  const double* right = b.data + j * b.beside;
  for (std::ptrdiff_t k = 0; k < a.columns; ++k, left += a.stride, right += b.next) {
    Lanes column[registers];
    for (int r = 0; r < registers; ++r) column[r] = read_lanes(left + r * lane_count);
    for (int c = 0; c < width; ++c) {
      const double factor = right[c * b.beside];
      for (int r = 0; r < registers; ++r) sums[r][c] += column[r] * factor;
    }
  }
  for (int c = 0; c < width; ++c) {
    double* to = result.data + (j + c) * result.stride + i;
    for (int r = 0; r < registers; ++r, to += lane_count) {
      write_lanes(to, subtracts ? read_lanes(to) - sums[r][c] : sums[r][c]);
    }
  }
}

/// Computes `width` columns of A B from column j, rows from i; A has at least as many rows as a
/// register. The last tile overlaps the one before it, so that every tile is full.
template <int registers, int width>
inline void multiply_rows(const ConstColumns& a, const Factors& b, const Columns& result,
                          std::ptrdiff_t i, std::ptrdiff_t j) {
  for (; i + registers * lane_count <= a.rows; i += registers * lane_count) {
    multiply_tile<registers, width>(a, b, result, i, j);
  }
  if constexpr (registers > 1) {
    multiply_rows<registers / 2, width>(a, b, result, i, j);
  } else if (i < a.rows) {
    multiply_tile<1, width>(a, b, result, a.rows - lane_count, j);
  }
}

/// Computes `width` columns of A B from column j, rows from `first`.
template <int width>
inline void multiply_strip(const ConstColumns& a, const Factors& b, const Columns& result,
                           std::ptrdiff_t first, std::ptrdiff_t j) {
  // A single column needs many registers so that its sums do not wait for each other.
  constexpr int registers = width == 1 ? 8 : 2;
  if (a.rows >= lane_count) return multiply_rows<registers, width>(a, b, result, first, j);
  for (std::ptrdiff_t c = j; c < j + width; ++c) {
    for (std::ptrdiff_t i = first; i < a.rows; ++i) {
      double sum = 0;
      for (std::ptrdiff_t k = 0; k < a.columns; ++k) {
        sum += a.data[k * a.stride + i] * b.data[c * b.beside + k * b.next];
      }
      result.data[c * result.stride + i] = sum;
    }
  }
}

inline void multiply(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
  const Factors factors = {b.data, 1, b.stride};
  if (b.columns >= strip_width) {
    for (std::ptrdiff_t j = 0; j < b.columns; j += strip_width) {
      multiply_strip<strip_width>(a, factors, result, 0, smaller(j, b.columns - strip_width));
    }
    return;
  }
  if (b.columns == 3) multiply_strip<3>(a, factors, result, 0, 0);
  if (b.columns == 2) multiply_strip<2>(a, factors, result, 0, 0);
  if (b.columns == 1) multiply_strip<1>(a, factors, result, 0, 0);
}

inline void multiply_symmetric(const ConstColumns& a, const ConstColumns& b,
                               const Columns& result) {
  const Factors factors = {b.data, b.stride, 1};
  const std::ptrdiff_t n = a.rows;
  std::ptrdiff_t j = 0;
  for (; j + strip_width <= n; j += strip_width)
    multiply_strip<strip_width>(a, factors, result, j, j);
  for (; j < n; ++j) multiply_strip<1>(a, factors, result, j, j);
  for (j = 0; j < n; ++j) {
    for (std::ptrdiff_t i = j + 1; i < n; ++i) {
      result.data[i * result.stride + j] = result.data[j * result.stride + i];
    }
  }
}

inline void reflect(const Columns& a, const double* v, double tau, double* w) {
  const std::ptrdiff_t n = a.rows;
  // w = tau A v - (tau^2 v.A v / 2) v, so that P A P = A - v w^T - w v^T
  multiply({a.data, n, n, a.stride}, {v, n, 1, n}, {w, n, 1, n});
  const double along = -tau / 2 * dot(v, w, n);
  for (std::ptrdiff_t i = 0; i < n; ++i) w[i] = tau * (w[i] + along * v[i]);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    double* column = a.data + j * a.stride;
    add_multiple(v, -w[j], n, column);
    add_multiple(w, -v[j], n, column);
  }
}

inline void add_weighted_products(const WeightedProduct& a, const WeightedProduct& b,
                                  const Columns& result) {
  const auto element = [](const WeightedProduct& of, std::ptrdiff_t row, std::ptrdiff_t column) {
    const double* left = of.left.data + row;
    const double* right = of.right.data + column;
    return of.weights.data[column * of.weights.stride + row] *
           (left[0] * right[0] + left[of.left.stride] * right[of.right.stride] +
            left[2 * of.left.stride] * right[2 * of.right.stride]);
  };
  for (std::ptrdiff_t j = 0; j < result.columns; ++j) {
    double* to = result.data + j * result.stride;
#pragma omp simd
    for (std::ptrdiff_t i = 0; i < result.rows; ++i) to[i] = element(a, i, j) + element(b, i, j);
  }
}

// Cholesky factor and its solutions

/// Returns the first row of the register that contains a row.
inline std::ptrdiff_t register_of(std::ptrdiff_t row) { return row / lane_count * lane_count; }

/// Factors `width` columns from column j on; all columns before j are factored.
template <int width>
inline bool factor_strip(const Columns& a, std::ptrdiff_t j) {
  const std::ptrdiff_t first = register_of(j);
  const ConstColumns before = {a.data, a.rows, j, a.stride};
  const Factors factors = {a.data, a.stride, 1};
  std::ptrdiff_t i = first;
  for (; i + lane_count < a.rows; i += 2 * lane_count) {
    multiply_tile<2, width, true>(before, factors, a, i, j);
  }
  if (i < a.rows) multiply_tile<1, width, true>(before, factors, a, i, j);
  for (std::ptrdiff_t c = j; c < j + width; ++c) {
    double* column = a.data + c * a.stride;
    if (!(column[c] > 0)) return false;
    const double scale = 1 / __builtin_sqrt(column[c]);
    for (i = first; i < a.rows; i += lane_count) {
      write_lanes(column + i, read_lanes(column + i) * scale);
    }
    for (std::ptrdiff_t later = c + 1; later < j + width; ++later) {
      double* to = a.data + later * a.stride;
      const double factor = column[later];
      for (i = first; i < a.rows; i += lane_count) {
        write_lanes(to + i, read_lanes(to + i) - read_lanes(column + i) * factor);
      }
    }
    column[c] = scale;
  }
  return true;
}

inline bool factor(const Columns& a) {
  std::ptrdiff_t j = 0;
  for (; j + strip_width <= a.columns; j += strip_width) {
    if (!factor_strip<strip_width>(a, j)) return false;
  }
  for (; j < a.columns; ++j) {
    if (!factor_strip<1>(a, j)) return false;
  }
  return true;
}

/// Solves L y = x for `width` unknowns from j on, and subtracts their contribution from later rows.
template <int width>
inline void solve_forward(const ConstColumns& l, double* x, std::ptrdiff_t j) {
  const double* columns[width] = {};
  double y[width] = {};
  for (int c = 0; c < width; ++c) {
    columns[c] = l.data + (j + c) * l.stride;
    y[c] = x[j + c];
    for (int before = 0; before < c; ++before) y[c] -= columns[before][j + c] * y[before];
    y[c] *= columns[c][j + c];
    x[j + c] = y[c];
  }
  std::ptrdiff_t i = j + width;
  for (; i + lane_count <= l.rows; i += lane_count) {
    Lanes rest = read_lanes(x + i);
    for (int c = 0; c < width; ++c) rest -= read_lanes(columns[c] + i) * y[c];
    write_lanes(x + i, rest);
  }
  for (; i < l.rows; ++i) {
    for (int c = 0; c < width; ++c) x[i] -= columns[c][i] * y[c];
  }
}

inline double lane_sum(Lanes lanes) {
  for (std::ptrdiff_t half = lane_count / 2; half > 0; half /= 2) {
    for (std::ptrdiff_t lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
  }
  return lanes[0];
}

/// Solves L^T y = x for `width` unknowns from j on; all unknowns after them are known.
template <int width>
inline void solve_backward(const ConstColumns& l, double* x, std::ptrdiff_t j) {
  const double* columns[width] = {};
  Lanes sums[width] = {};
  double y[width] = {};
  for (int c = 0; c < width; ++c) {
    columns[c] = l.data + (j + c) * l.stride;
    y[c] = x[j + c];
  }
  std::ptrdiff_t i = j + width;
  for (; i + lane_count <= l.rows; i += lane_count) {
    const Lanes known = read_lanes(x + i);
    for (int c = 0; c < width; ++c) sums[c] += read_lanes(columns[c] + i) * known;
  }
  for (int c = 0; c < width && i > j + width; ++c) y[c] -= lane_sum(sums[c]);
  for (; i < l.rows; ++i) {
    for (int c = 0; c < width; ++c) y[c] -= columns[c][i] * x[i];
  }
  for (int c = width; c-- > 0;) {
    for (int later = c + 1; later < width; ++later) y[c] -= columns[c][j + later] * y[later];
    y[c] *= columns[c][j + c];
    x[j + c] = y[c];
  }
}

inline void solve(const ConstColumns& l, double* x) {
  const std::ptrdiff_t whole = l.rows / strip_width * strip_width;
  std::ptrdiff_t j = 0;
  for (; j < whole; j += strip_width) solve_forward<strip_width>(l, x, j);
  for (; j < l.rows; ++j) solve_forward<1>(l, x, j);
  for (; j > whole; --j) solve_backward<1>(l, x, j - 1);
  for (; j > 0; j -= strip_width) solve_backward<strip_width>(l, x, j - strip_width);
}

// Quaternions, sines and cosines

struct Quaternion {
  double w, x, y, z;
};

template <typename Matrix>
inline Quaternion quaternion(const Matrix& from, std::ptrdiff_t row) {
  const double* at = from.data + row;
  return {at[0], at[from.stride], at[2 * from.stride], at[3 * from.stride]};
}

inline void write(const Columns& to, std::ptrdiff_t row, const Quaternion& q) {
  double* at = to.data + row;
  at[0] = q.w;
  at[to.stride] = q.x;
  at[2 * to.stride] = q.y;
  at[3 * to.stride] = q.z;
}

inline void multiply_by_two_strains(const ConstColumns& q, const ConstColumns& u, double scale,
                                    const Columns& result) {
#pragma omp simd
  for (std::ptrdiff_t row = 0; row < q.rows; ++row) {
    const Quaternion from = quaternion(q, row);
    const double a = u.data[row] * scale;
    const double b = u.data[u.stride + row] * scale;
    write(result, row,
          {-from.x * a - from.y * b, from.w * a - from.z * b, from.w * b + from.z * a,
           from.x * b - from.y * a});
  }
}

inline void multiply_by_conjugate(const Columns& a, const ConstColumns& b) {
#pragma omp simd
  for (std::ptrdiff_t row = 0; row < a.rows; ++row) {
    const Quaternion p = quaternion(a, row);
    const Quaternion q = quaternion(b, row);
    write(a, row,
          {p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z,
           -p.w * q.x + p.x * q.w - p.y * q.z + p.z * q.y,
           -p.w * q.y + p.y * q.w - p.z * q.x + p.x * q.z,
           -p.w * q.z + p.z * q.w - p.x * q.y + p.y * q.x});
  }
}

inline void add_product(const Columns& q, const ConstColumns& a) {
#pragma omp simd
  for (std::ptrdiff_t row = 0; row < q.rows; ++row) {
    const Quaternion p = quaternion(q, row);
    Quaternion by = quaternion(a, row);
    by.w += 1.0;
    const Quaternion sum = {by.w * p.w - by.x * p.x - by.y * p.y - by.z * p.z,
                            by.w * p.x + by.x * p.w + by.y * p.z - by.z * p.y,
                            by.w * p.y + by.y * p.w + by.z * p.x - by.x * p.z,
                            by.w * p.z + by.z * p.w + by.x * p.y - by.y * p.x};
    const double size =
        __builtin_sqrt(sum.w * sum.w + sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    write(q, row, {sum.w / size, sum.x / size, sum.y / size, sum.z / size});
  }
}

/// Computes cosines and sines.
/// (a) Subtracts the nearest multiple k of pi/2, given as a sum of three numbers. The first two
/// have 33 bits, so that their products with k are exact.
/// (b) Evaluates Taylor's series of the remainder, truncated as in fdlibm and with its
/// coefficients.
/// (c) Exchanges sine and cosine if k is odd, and sets the signs from k, the last bits of which
/// `shift` has left at the end of the mantissa.
inline void turn(const double* angles, std::ptrdiff_t count, double* cosines, double* sines) {
  constexpr double shift = 0x1.8p52;
  constexpr double per_quarter = 6.36619772367581382433e-01;
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const double shifted = angles[i] * per_quarter + shift;
    const double k = shifted - shift;
    double r = angles[i] - k * 1.57079632673412561417e+00;  // (a)
    r = r - k * 6.07710050630396597660e-11;
    r = r - k * 2.02226624879595063154e-21;
    const double z = r * r;  // (b)
    double s = z * 1.58969099521155010221e-10 - 2.50507602534068634195e-08;
    s = z * s + 2.75573137070700676789e-06;
    s = z * s - 1.98412698298579493134e-04;
    s = z * s + 8.33333333332248946124e-03;
    s = z * s - 1.66666666666666324348e-01;
    s = r + r * z * s;
    double c = z * -1.13596475577881948265e-11 + 2.08757232129817482790e-09;
    c = z * c - 2.75573143513906633035e-07;
    c = z * c + 2.48015872894767294178e-05;
    c = z * c - 1.38888888888741095749e-03;
    c = z * c + 4.16666666666666019037e-02;
    const double half = 0.5 * z;
    const double most = 1.0 - half;
    c = most + (((1.0 - most) - half) + z * z * c);
    const auto quarter = __builtin_bit_cast(long long, shifted);  // (c)
    const bool odd = (quarter & 1) != 0;
    const double sine = odd ? c : s;
    const double cosine = odd ? s : c;
    sines[i] = (quarter & 2) != 0 ? -sine : sine;
    cosines[i] = ((quarter + 1) & 2) != 0 ? -cosine : cosine;
  }
}

const DenseKernel& dense_kernel() {
  static constexpr DenseKernel kernel = {multiply,
                                         multiply_symmetric,
                                         multiply_by_two_strains,
                                         multiply_by_conjugate,
                                         add_product,
                                         factor,
                                         solve,
                                         reflect,
                                         turn,
                                         add_weighted_products};
  return kernel;
}

}  // namespace dlo::energy_model::DLO_KERNEL
