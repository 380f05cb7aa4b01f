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

/// Computes a tile of A B: `registers` registers of rows from row i, and `width` columns from
/// column j.
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

/// Computes `width` columns of A B from column j, rows from `first`. The last tile overlaps the one
/// before it, so that every tile is full.
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

/// Computes A b for a single column, with enough registers that the sums do not wait for each
/// other.
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
  if (b.columns == 1) multiply_column(a, factors, result);
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
  const double along = -tau / 2 * dot_of_lanes(v, w, n);
  for (std::ptrdiff_t i = 0; i < n; ++i) w[i] = tau * (w[i] + along * v[i]);
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    double* column = a.data + j * a.stride;
    add_multiple(v, -w[j], n, column);
    add_multiple(w, -v[j], n, column);
  }
}

/// Returns an element (or a register of elements) of weights o (left right^T). @param right  row of
/// `right` that belongs to the column
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

inline void add_weighed(const WeighedProduct& a, const WeighedProduct& b, const Columns& result) {
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

}  // namespace dlo::energy_model::DLO_KERNEL
