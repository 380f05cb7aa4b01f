#pragma once

#include "linear/kernel_lanes.hpp"

// Quaternions, sines and cosines. A part of dense_kernel.cpp, whose rules apply here.
namespace dlo::energy_model::DLO_KERNEL {

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

inline void multiply_by_two_strains(const ConstColumns& q, const ConstColumns& u, double scale,
                                    const Columns& result) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= q.rows; r += lane_count) strains_row<Lanes>(q, u, scale, result, r);
  for (; r < q.rows; ++r) strains_row<double>(q, u, scale, result, r);
}

inline void multiply_by_conjugate(const Columns& a, const ConstColumns& b) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= a.rows; r += lane_count) conjugate_row<Lanes>(a, b, r);
  for (; r < a.rows; ++r) conjugate_row<double>(a, b, r);
}

inline void add_product(const Columns& q, const ConstColumns& a) {
  std::ptrdiff_t r = 0;
  for (; r + lane_count <= q.rows; r += lane_count) add_row<Lanes>(q, a, r);
  for (; r < q.rows; ++r) add_row<double>(q, a, r);
}

using Bits [[gnu::vector_size(lane_count * sizeof(double))]] = long long;

/// Computes cosines and sines of the angles in one register.
/// (a) Subtracts the nearest multiple k of pi/2, given as a sum of three numbers. The first two
/// have 33 bits, so that their products with k are exact.
/// (b) Evaluates Taylor's series of the remainder, truncated as in fdlibm and with its
/// coefficients.
/// (c) Exchanges sine and cosine if k is odd, and sets the signs from k, the last bits of which
/// `shift` has left at the end of the mantissa.
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

inline void turn(const double* angles, std::ptrdiff_t count, double* cosines, double* sines) {
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

}  // namespace dlo::energy_model::DLO_KERNEL
