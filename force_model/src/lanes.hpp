#pragma once

#include <cstddef>

// Arithmetic on as many numbers as one register of the instruction set holds that the including
// file is compiled for. Only step_kernel.cpp includes this.

namespace dlo::force_model::DLO_KERNEL {

#if defined(__AVX512F__)
inline constexpr int lane_count = 8;
#elif defined(__AVX2__)
inline constexpr int lane_count = 4;
#else
inline constexpr int lane_count = 2;
#endif

/// A register; + - * / and comparisons act on each lane (GCC and Clang vector extension).
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;
/// Per lane: -1 where a comparison holds, 0 where not.
using LaneMask [[gnu::vector_size(lane_count * sizeof(double))]] = long long;

/// As stored: arrays of doubles hold registers at any element.
using StoredLanes [[gnu::vector_size(lane_count * sizeof(double)), gnu::aligned(sizeof(double)),
                    gnu::may_alias]] = double;

inline Lanes read_lanes(const double* from) { return *reinterpret_cast<const StoredLanes*>(from); }
inline void write_lanes(double* to, Lanes value) { *reinterpret_cast<StoredLanes*>(to) = value; }

inline Lanes sqrt(Lanes a) {
  Lanes root{};
  for (int i = 0; i < lane_count; ++i) root[i] = __builtin_sqrt(a[i]);
  return root;
}

inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }

/// Vectors in the plane or in space, one per lane.
template <int dimension>
struct LaneVector {
  Lanes axis[dimension];

  friend LaneVector operator+(LaneVector a, const LaneVector& b) {
    for (int i = 0; i < dimension; ++i) a.axis[i] += b.axis[i];
    return a;
  }
  friend LaneVector operator-(LaneVector a, const LaneVector& b) {
    for (int i = 0; i < dimension; ++i) a.axis[i] -= b.axis[i];
    return a;
  }
  friend LaneVector operator*(const Lanes& factor, LaneVector a) {
    for (int i = 0; i < dimension; ++i) a.axis[i] *= factor;
    return a;
  }
  friend Lanes dot(const LaneVector& a, const LaneVector& b) {
    Lanes sum = a.axis[0] * b.axis[0];
    for (int i = 1; i < dimension; ++i) sum += a.axis[i] * b.axis[i];
    return sum;
  }
};

}  // namespace dlo::force_model::DLO_KERNEL
