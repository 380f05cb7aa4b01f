#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace dlo::energy_model {

/// Orthonormal Legendre polynomials p_k on [0, 1] at the Q nodes of a Gauss-Legendre rule. All Q
/// polynomials are tabulated, the first K are the unknowns' own.
struct LegendreTable {
  Eigen::VectorXd nodes;        ///< Q
  Eigen::VectorXd weights;      ///< Q, sum 1
  Eigen::MatrixXd values;       ///< p_k at the nodes, Q x Q
  Eigen::MatrixXd integrals;    ///< int_0^node p_k, Q x Q
  Eigen::MatrixXd integration;  ///< from values at the nodes to int_0^node, Q x Q
  /// Of `values` and `integration`.
  Eigen::MatrixXd values_transposed, integration_transposed;
  /// From values f at the nodes to c and a_k with c + sum_{k < K} a_k int_0^node p_k nearest to f,
  /// (K + 1) x Q.
  Eigen::MatrixXd fit;
};

/// Values p_k(xi) and integrals int_0^xi p_k for k = 0 .. K-1 into `values` and `integrals`.
void legendre(double xi, Eigen::Ref<Eigen::VectorXd> values, Eigen::Ref<Eigen::VectorXd> integrals);

/// Derivatives p_k'(xi) for k = 0 .. K-1.
void legendre_slopes(double xi, Eigen::Ref<Eigen::VectorXd> slopes);

/// Table of K terms, made once and kept, with Q = K + 6: for a tangent angle of degree K the sines
/// and cosines of the integrand are then resolved as far as the angle itself is. Safe to call from
/// several threads.
[[nodiscard]] const LegendreTable& legendre_table(int terms);

/// The same with Q = 3 K / 2 + 8, on which directors are collocated whose strains have K terms.
[[nodiscard]] const LegendreTable& director_table(int terms);

/// Largest number of terms that the tables know.
inline constexpr int max_terms = 128;

/// An angle by its start and the coefficients of its derivative, piece by piece.
struct FittedAngle {
  double start = 0;
  Eigen::VectorXd coefficients;
};

/// The angle nearest to values at the nodes of all pieces, by least squares on each piece.
/// @param turns  rotation, by the coefficient of p_0 = 1, of the end of each piece (Piece::angle())
/// @param start  of the angle, if it is known
[[nodiscard]] FittedAngle fit_angle(const LegendreTable& table, const std::vector<double>& turns,
                                    const Eigen::VectorXd& angles, std::optional<double> start);

}  // namespace dlo::energy_model
