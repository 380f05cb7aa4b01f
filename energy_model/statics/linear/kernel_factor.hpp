#pragma once

#include "linear/kernel_products.hpp"

// Cholesky factor and its solutions. A part of dense_kernel.cpp, whose rules apply here.
namespace dlo::energy_model::DLO_KERNEL {

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

inline double sum_of(Lanes lanes) {
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

inline void solve(const ConstColumns& l, double* x) {
  constexpr std::ptrdiff_t width = 4;
  const std::ptrdiff_t whole = l.rows / width * width;
  std::ptrdiff_t j = 0;
  for (; j < whole; j += width) solve_forward<width>(l, x, j);
  for (; j < l.rows; ++j) solve_forward<1>(l, x, j);
  for (; j > whole; --j) solve_backward<1>(l, x, j - 1);
  for (; j > 0; j -= width) solve_backward<width>(l, x, j - width);
}

}  // namespace dlo::energy_model::DLO_KERNEL
