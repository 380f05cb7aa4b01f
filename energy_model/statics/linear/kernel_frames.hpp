#pragma once

#include "linear/kernel_lanes.hpp"

// Quaternions, sines and cosines. A part of dense_kernel.cpp, whose rules apply here.
namespace dlo::energy_model::DLO_KERNEL {

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

}  // namespace dlo::energy_model::DLO_KERNEL
