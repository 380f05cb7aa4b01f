#pragma once

#include "linear/kernel_lanes.hpp"

// Products of matrices. A part of dense_kernel.cpp, whose rules apply here.
namespace dlo::energy_model::DLO_KERNEL {

/// Factors of the columns of A in a product: element k of column j of the right operand is stored
/// at data + k * next + j * beside.
struct Factors {
  const double* data;
  std::ptrdiff_t next, beside;
};

/// Computes a tile of A B, or subtracts it from the result: `registers` registers of rows from row
/// i, and `width` columns from column j.
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
  if (a.rows >= lane_count)
    return multiply_rows < width == 1 ? 8 : 2, width > (a, b, result, first, j);
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
  if (b.columns == 1) multiply_strip<1>(a, factors, result, 0, 0);
}

inline void multiply_symmetric(const ConstColumns& a, const ConstColumns& b,
                               const Columns& result) {
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

inline void add_weighed(const WeighedProduct& a, const WeighedProduct& b, const Columns& result) {
  const auto element = [](const WeighedProduct& of, std::ptrdiff_t row, std::ptrdiff_t column) {
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

}  // namespace dlo::energy_model::DLO_KERNEL
