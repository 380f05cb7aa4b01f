#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// Orthonormal Legendre polynomials p_k on [0, 1] at the Q nodes of a Gauss-Legendre rule. All Q
/// polynomials are tabulated; the unknowns are the coefficients of the first K.
struct LegendreTable {
  Eigen::VectorXd nodes;        ///< Q nodes in [0, 1]
  Eigen::VectorXd weights;      ///< Q weights, sum 1
  Eigen::MatrixXd values;       ///< p_k at the nodes, Q x Q
  Eigen::MatrixXd integrals;    ///< int_0^node p_k, Q x Q
  Eigen::MatrixXd integration;  ///< maps values at the nodes to int_0^node, Q x Q
  /// Transposed matrices of `values` and `integration`.
  Eigen::MatrixXd values_transposed, integration_transposed;
  /// Maps values f at the nodes to c and a_k, for which c + sum_{k < K} a_k int_0^node p_k is
  /// nearest to f; (K + 1) x Q.
  Eigen::MatrixXd fit;
};

/// Computes the values p_k(xi) and the integrals int_0^xi p_k for k = 0 .. K-1.
void legendre(double xi, Eigen::Ref<Eigen::VectorXd> values, Eigen::Ref<Eigen::VectorXd> integrals);

/// Computes the derivatives p_k'(xi) for k = 0 .. K-1.
void legendre_slopes(double xi, Eigen::Ref<Eigen::VectorXd> slopes);

/// Returns the table for K terms, which is computed once, with Q = K + 6. The sines and cosines of
/// a tangent angle of degree K in the integrand are then resolved as accurately as the angle
/// itself. Thread-safe.
/// @throws std::invalid_argument unless 1 <= terms <= max_terms
[[nodiscard]] const LegendreTable& legendre_table(int terms);

/// Returns the table for K terms with Q = 3 K / 2 + 8, at whose nodes directors with strains of K
/// terms are collocated. Thread-safe.
/// @throws std::invalid_argument unless 1 <= terms <= max_terms
[[nodiscard]] const LegendreTable& director_table(int terms);

/// Largest number of terms of a table.
inline constexpr int max_terms = 128;

/// An angle by its start value and the coefficients of its derivative, element by element.
struct FittedAngle {
  double start = 0;
  Eigen::VectorXd coefficients;
};

/// Fits an angle to values at the nodes of all elements, by least squares on each element.
/// @param turns  rotation of the end of each element for a coefficient of 1 of p_0 = 1
///               (Element::angle())
/// @param start  start value of the angle, if it is prescribed
[[nodiscard]] FittedAngle fit_angle(const LegendreTable& table, const std::vector<double>& turns,
                                    const Eigen::VectorXd& angles, std::optional<double> start);

}  // namespace dlo::energy_model
