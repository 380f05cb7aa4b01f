#include "linear/dense_kernel.hpp"

// Compiled once for each instruction set, DLO_KERNEL naming the namespace (see CMakeLists.txt).
// Nothing inline from a library that another file might compile too may be used in here but what
// the compiler is sure to inline: of such a function the linker keeps one copy, perhaps one with
// instructions that the machine lacks.

namespace dlo::energy_model::DLO_KERNEL {
namespace {

#if defined(__AVX512F__)
constexpr std::ptrdiff_t lane_count = 8;
#elif defined(__AVX2__)
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

/// Factors by which the columns of A are multiplied: element k of column j of the result is at
/// data + k * next + j * beside.
struct Factors {
  const double* data;
  std::ptrdiff_t next, beside;
};

/// `registers` of rows from row i on, and `width` columns from column j on, of A B.
template <int registers, int width>
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
    for (int r = 0; r < registers; ++r) write_lanes(to + r * lane_count, sums[r][c]);
  }
}

/// Rows from `first` on of `width` columns of A B from column j on. The last rows are worked out
/// with as many before them as fill a tile.
template <int width>
inline void multiply_strip(const ConstColumns& a, const Factors& b, const Columns& result,
                           std::ptrdiff_t first, std::ptrdiff_t j) {
  constexpr int registers = 2;
  constexpr std::ptrdiff_t tall = registers * lane_count;
  if (a.rows >= lane_count) {
    std::ptrdiff_t i = first;
    for (; i + lane_count < a.rows && a.rows >= tall; i += tall) {
      multiply_tile<registers, width>(a, b, result, smaller(i, a.rows - tall), j);
    }
    for (; i < a.rows; i += lane_count) {
      multiply_tile<1, width>(a, b, result, smaller(i, a.rows - lane_count), j);
    }
    return;
  }
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

/// A b of one column, with as many registers as keep sums from waiting for each other.
inline void multiply_column(const ConstColumns& a, const Factors& b, const Columns& result) {
  std::ptrdiff_t i = 0;
  for (; i + 8 * lane_count <= a.rows; i += 8 * lane_count) {
    multiply_tile<8, 1>(a, b, result, i, 0);
  }
  for (; i + 4 * lane_count <= a.rows; i += 4 * lane_count) {
    multiply_tile<4, 1>(a, b, result, i, 0);
  }
  if (i < a.rows) multiply_strip<1>(a, b, result, i, 0);
}

void multiply(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
  constexpr std::ptrdiff_t width = 4;
  const Factors factors = {b.data, 1, b.stride};
  if (b.columns >= width) {
    for (std::ptrdiff_t j = 0; j < b.columns; j += width) {
      multiply_strip<width>(a, factors, result, 0, smaller(j, b.columns - width));
    }
    return;
  }
  if (b.columns == 3) multiply_strip<3>(a, factors, result, 0, 0);
  if (b.columns == 2) multiply_strip<2>(a, factors, result, 0, 0);
  if (b.columns == 1) multiply_column(a, factors, result);
}

void multiply_symmetric(const ConstColumns& a, const ConstColumns& b, const Columns& result) {
  constexpr std::ptrdiff_t width = 4;
  const Factors factors = {b.data, b.stride, 1};
  const std::ptrdiff_t n = a.rows;
  std::ptrdiff_t j = 0;
  for (; j + width <= n; j += width) multiply_strip<width>(a, factors, result, j, j);
  for (; j < n; ++j) multiply_strip<1>(a, factors, result, j, j);
  for (j = 0; j < n; ++j) {
    for (std::ptrdiff_t i = j + 1; i < n; ++i) {
      result.data[i * result.stride + j] = result.data[j * result.stride + i];
    }
  }
}

inline double dot(const double* a, const double* b, std::ptrdiff_t size) {
  double sum = 0;
  for (std::ptrdiff_t k = 0; k < size; ++k) sum += a[k] * b[k];
  return sum;
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

/// `registers` of rows from row i on of `width` columns from column j on, less what the columns
/// before have put into L L^T there.
template <int registers, int width>
inline void subtract_tile(const Columns& a, std::ptrdiff_t i, std::ptrdiff_t j) {
  Lanes rest[registers][width];
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r) {
      rest[r][c] = read_lanes(a.data + (j + c) * a.stride + i + r * lane_count);
    }
  }
  const double* left = a.data + i;
  const double* right = a.data + j;
  for (std::ptrdiff_t k = 0; k < j; ++k, left += a.stride, right += a.stride) {
    Lanes column[registers];
    for (int r = 0; r < registers; ++r) column[r] = read_lanes(left + r * lane_count);
    for (int c = 0; c < width; ++c) {
      for (int r = 0; r < registers; ++r) rest[r][c] -= column[r] * right[c];
    }
  }
  for (int c = 0; c < width; ++c) {
    for (int r = 0; r < registers; ++r) {
      write_lanes(a.data + (j + c) * a.stride + i + r * lane_count, rest[r][c]);
    }
  }
}

/// The register that a row is in.
inline std::ptrdiff_t register_of(std::ptrdiff_t row) { return row / lane_count * lane_count; }

/// `width` columns from column j on, of which those before are done.
template <int width>
inline bool factor_strip(const Columns& a, std::ptrdiff_t j) {
  const std::ptrdiff_t first = register_of(j);
  std::ptrdiff_t i = first;
  for (; i + lane_count < a.rows; i += 2 * lane_count) subtract_tile<2, width>(a, i, j);
  if (i < a.rows) subtract_tile<1, width>(a, i, j);
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

bool factor(const Columns& a) {
  constexpr std::ptrdiff_t width = 4;
  std::ptrdiff_t j = 0;
  for (; j + width <= a.columns; j += width) {
    if (!factor_strip<width>(a, j)) return false;
  }
  for (; j < a.columns; ++j) {
    if (!factor_strip<1>(a, j)) return false;
  }
  return true;
}

/// to = to + factor from
inline void add_multiple(const double* from, double factor, std::ptrdiff_t size, double* to) {
  std::ptrdiff_t i = 0;
  for (; i + lane_count <= size; i += lane_count) {
    write_lanes(to + i, read_lanes(to + i) + read_lanes(from + i) * factor);
  }
  for (; i < size; ++i) to[i] += factor * from[i];
}

inline double dot_of_lanes(const double* a, const double* b, std::ptrdiff_t size) {
  Lanes sums{};
  std::ptrdiff_t i = 0;
  for (; i + lane_count <= size; i += lane_count) sums += read_lanes(a + i) * read_lanes(b + i);
  double sum = dot(a + i, b + i, size - i);
  for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) sum += sums[lane];
  return sum;
}

/// `width` unknowns from j on of L y = x, and what they take from those beyond.
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

inline double sum_of(Lanes lanes) {
  for (std::ptrdiff_t half = lane_count / 2; half > 0; half /= 2) {
    for (std::ptrdiff_t lane = 0; lane < half; ++lane) lanes[lane] += lanes[lane + half];
  }
  return lanes[0];
}

/// `width` unknowns from j on of L^T y = x, where those beyond are known.
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
  for (int c = 0; c < width && i > j + width; ++c) y[c] -= sum_of(sums[c]);
  for (; i < l.rows; ++i) {
    for (int c = 0; c < width; ++c) y[c] -= columns[c][i] * x[i];
  }
  for (int c = width; c-- > 0;) {
    for (int later = c + 1; later < width; ++later) y[c] -= columns[c][j + later] * y[later];
    y[c] *= columns[c][j + c];
    x[j + c] = y[c];
  }
}

void solve(const ConstColumns& l, double* x) {
  constexpr std::ptrdiff_t width = 4;
  const std::ptrdiff_t whole = l.rows / width * width;
  std::ptrdiff_t j = 0;
  for (; j < whole; j += width) solve_forward<width>(l, x, j);
  for (; j < l.rows; ++j) solve_forward<1>(l, x, j);
  for (; j > whole; --j) solve_backward<1>(l, x, j - 1);
  for (; j > 0; j -= width) solve_backward<width>(l, x, j - width);
}

void reflect(const Columns& a, const double* v, double tau, double* w) {
  const std::ptrdiff_t n = a.rows;
  // w = tau A v - (tau^2 v.A v / 2) v, so that P A P = A - v w^T - w v^T
  multiply({a.data, n, n, a.stride}, {v, n, 1, n}, {w, n, 1, n});
  const double along = -tau / 2 * dot_of_lanes(v, w, n);
  for (std::ptrdiff_t i = 0; i < n; ++i) w[i] = tau * (w[i] + along * v[i]);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    double* column = a.data + j * a.stride;
    add_multiple(v, -w[j], n, column);
    add_multiple(w, -v[j], n, column);
  }
}

using Bits [[gnu::vector_size(lane_count * sizeof(double))]] = long long;

/// (a) The angle less the nearest multiple k of pi/2, a sum of three numbers of which the first two
///     have 33 bits: k times them is exact.
/// (b) Taylor's series on what is left, cut where fdlibm cuts it and with its coefficients.
/// (c) Odd k exchange sine and cosine; signs follow from k, of which `shift` has left the last bits
///     at the end of the mantissa.
inline void turn_lanes(Lanes angle, Lanes& cosine, Lanes& sine) {
  constexpr double shift = 0x1.8p52;
  constexpr double per_quarter = 6.36619772367581382433e-01;
  const Lanes shifted = angle * per_quarter + shift;
  const Lanes k = shifted - shift;
  Lanes r = angle - k * 1.57079632673412561417e+00;  // (a)
  r = r - k * 6.07710050630396597660e-11;
  r = r - k * 2.02226624879595063154e-21;
  const Lanes z = r * r;  // (b)
  Lanes s = z * 1.58969099521155010221e-10 - 2.50507602534068634195e-08;
  s = z * s + 2.75573137070700676789e-06;
  s = z * s - 1.98412698298579493134e-04;
  s = z * s + 8.33333333332248946124e-03;
  s = z * s - 1.66666666666666324348e-01;
  s = r + r * z * s;
  Lanes c = z * -1.13596475577881948265e-11 + 2.08757232129817482790e-09;
  c = z * c - 2.75573143513906633035e-07;
  c = z * c + 2.48015872894767294178e-05;
  c = z * c - 1.38888888888741095749e-03;
  c = z * c + 4.16666666666666019037e-02;
  const Lanes half = 0.5 * z;
  const Lanes most = 1.0 - half;
  c = most + (((1.0 - most) - half) + z * z * c);
  const Bits quarter = reinterpret_cast<Bits>(shifted);  // (c)
  const Bits odd = -(quarter & 1);
  const Bits of_s = reinterpret_cast<Bits>(s);
  const Bits of_c = reinterpret_cast<Bits>(c);
  const Bits sines = ((of_s & ~odd) | (of_c & odd)) ^ ((quarter & 2) << 62);
  const Bits cosines = ((of_c & ~odd) | (of_s & odd)) ^ (((quarter + 1) & 2) << 62);
  sine = reinterpret_cast<Lanes>(sines);
  cosine = reinterpret_cast<Lanes>(cosines);
}

void turn(const double* angles, std::ptrdiff_t count, double* cosines, double* sines) {
  Lanes cosine, sine;
  std::ptrdiff_t i = 0;
  for (; i + lane_count <= count; i += lane_count) {
    turn_lanes(read_lanes(angles + i), cosine, sine);
    write_lanes(cosines + i, cosine);
    write_lanes(sines + i, sine);
  }
  if (i == count) return;
  Lanes rest{};
  for (std::ptrdiff_t lane = 0; lane < count - i; ++lane) rest[lane] = angles[i + lane];
  turn_lanes(rest, cosine, sine);
  for (std::ptrdiff_t lane = 0; lane < count - i; ++lane) {
    cosines[i + lane] = cosine[lane];
    sines[i + lane] = sine[lane];
  }
}

/// A row of A B^T times its weight, of one column of B^T.
template <typename Real>
inline Real weighed_row(const WeighedProduct& a, const double (&right)[3], std::ptrdiff_t column,
                        std::ptrdiff_t row) {
  const double* left = a.left.data + row;
  Real weight, x, y, z;
  read(a.weights.data + column * a.weights.stride + row, weight);
  read(left, x);
  read(left + a.left.stride, y);
  read(left + 2 * a.left.stride, z);
  return weight * (x * right[0] + y * right[1] + z * right[2]);
}

void add_weighed(const WeighedProduct& a, const WeighedProduct& b, const Columns& result) {
  const auto right_of = [](const WeighedProduct& of, std::ptrdiff_t column, double(&right)[3]) {
    for (std::ptrdiff_t i = 0; i < 3; ++i) right[i] = of.right.data[i * of.right.stride + column];
  };
  double of_a[3];
  double of_b[3];
  for (std::ptrdiff_t j = 0; j < result.columns; ++j) {
    right_of(a, j, of_a);
    right_of(b, j, of_b);
    double* to = result.data + j * result.stride;
    std::ptrdiff_t i = 0;
    for (; i + lane_count <= result.rows; i += lane_count) {
      write_lanes(to + i, weighed_row<Lanes>(a, of_a, j, i) + weighed_row<Lanes>(b, of_b, j, i));
    }
    for (; i < result.rows; ++i) {
      to[i] = weighed_row<double>(a, of_a, j, i) + weighed_row<double>(b, of_b, j, i);
    }
  }
}

}  // namespace

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
                                         add_weighed};
  return kernel;
}

}  // namespace dlo::energy_model::DLO_KERNEL
