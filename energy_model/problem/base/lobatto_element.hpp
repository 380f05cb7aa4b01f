#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace dlo::energy_model {

inline constexpr std::size_t element_order = 4;       // polynomial order of the elements
inline constexpr std::size_t element_quadrature = 6;  // Gauss nodes per element, exact to order 11

/// Gauss-Lobatto nodes of an element on [-1, 1].
inline const std::array<double, element_order + 1> element_lobatto = {-1, -std::sqrt(3.0 / 7.0), 0,
                                                                      std::sqrt(3.0 / 7.0), 1};
/// Gauss-Legendre nodes and weights on [-1, 1] (Abramowitz and Stegun, table 25.4).
inline constexpr std::array<double, element_quadrature> element_gauss = {
    -0.932469514203152028, -0.661209386466264514, -0.238619186083196909,
    0.238619186083196909,  0.661209386466264514,  0.932469514203152028};
inline constexpr std::array<double, element_quadrature> element_weight = {
    0.171324492379170345, 0.360761573048138608, 0.467913934572691047,
    0.467913934572691047, 0.360761573048138608, 0.171324492379170345};

/// Returns the Gauss nodes of all elements between neighbouring borders.
inline std::vector<double> gauss_points(const Eigen::VectorXd& borders) {
  std::vector<double> points;
  points.reserve(element_quadrature * static_cast<std::size_t>(borders.size()));
  for (Eigen::Index e = 0; e + 1 < borders.size(); ++e) {
    for (const double x : element_gauss) {
      points.push_back(borders[e] + (borders[e + 1] - borders[e]) * (1 + x) / 2);
    }
  }
  return points;
}

/// Values and derivatives of Lagrange's polynomials on the Lobatto nodes at the Gauss nodes.
struct ElementBasis {
  Eigen::Matrix<double, element_quadrature, element_order + 1> value;
  Eigen::Matrix<double, element_quadrature, element_order + 1> rate;

  ElementBasis() {
    for (std::size_t q = 0; q < element_quadrature; ++q) {
      for (std::size_t a = 0; a <= element_order; ++a) {
        double product = 1;
        double sum = 0;
        for (std::size_t b = 0; b <= element_order; ++b) {
          if (b == a) continue;
          const double factor = 1 / (element_lobatto[a] - element_lobatto[b]);
          sum = sum * (element_gauss[q] - element_lobatto[b]) * factor + product * factor;
          product *= (element_gauss[q] - element_lobatto[b]) * factor;
        }
        value(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(a)) = product;
        rate(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(a)) = sum;
      }
    }
  }
};

}  // namespace dlo::energy_model
