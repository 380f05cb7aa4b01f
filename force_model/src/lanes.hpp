#pragma once

#include <cstddef>
#include <utility>

// Arithmetic on as many numbers as one register of the instruction set holds that the including
// file is compiled for. Only step_kernel.cpp and its registers.hpp include this.

namespace dlo::force_model::DLO_KERNEL {

#if defined(__AVX512F__)
inline constexpr int lane_count = 8;
#elif defined(__AVX2__)
inline constexpr int lane_count = 4;
#else
inline constexpr int lane_count = 2;
#endif

/// Vector register; + - * / and comparisons act on each lane (GCC and Clang vector extension).
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;

/// Vector register in an array of doubles, at any element.
using StoredLanes [[gnu::vector_size(lane_count * sizeof(double)), gnu::aligned(sizeof(double)),
                    gnu::may_alias]] = double;

inline Lanes read_lanes(const double* from) { return *reinterpret_cast<const StoredLanes*>(from); }

inline void write_lanes(double* to, Lanes value) { *reinterpret_cast<StoredLanes*>(to) = value; }

inline Lanes all_lanes(double value) { return value - Lanes{}; }

inline Lanes sqrt(Lanes a) {
  Lanes root{};
  for (int i = 0; i < lane_count; ++i) root[i] = __builtin_sqrt(a[i]);
  return root;
}

inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes sum(Lanes a, Lanes b) { return a + b; }

/// Returns lanes `shift` to `shift` + lane_count - 1 of two consecutive registers.
template <int shift, int... lane>
Lanes window(Lanes first, Lanes second, std::integer_sequence<int, lane...> /*all*/) {
  return __builtin_shufflevector(first, second, (shift + lane)...);
}
template <int shift>
Lanes window(Lanes first, Lanes second) {
  return window<shift>(first, second, std::make_integer_sequence<int, lane_count>());
}

/// Reduces all lanes to one number: their maximum, minimum or sum.
template <Lanes combine(Lanes, Lanes), int half = lane_count / 2>
double reduce(Lanes a) {
  if constexpr (half == 0) {
    return a[0];
  } else {
    return reduce<combine, half / 2>(combine(a, window<half>(a, a)));
  }
}

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
    Lanes result = a.axis[0] * b.axis[0];
    for (int i = 1; i < dimension; ++i) result += a.axis[i] * b.axis[i];
    return result;
  }
};

}  // namespace dlo::force_model::DLO_KERNEL
