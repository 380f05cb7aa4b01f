#pragma once

#include "linear/dense_kernel.hpp"

// Registers and loops over their elements. A part of dense_kernel.cpp, whose rules apply here.
namespace dlo::energy_model::DLO_KERNEL {

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

/// to = to + factor from
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

}  // namespace dlo::energy_model::DLO_KERNEL
