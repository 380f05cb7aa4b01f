#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <limits>

namespace dlo::energy_model {

/// Eigenvalues of a second variation closer to zero than this count as zero [-].
inline constexpr double neutral_eigenvalue = 1e-7;

/// Weight of the constraints' own block: far below what the constraints see (1 / |C|^2), far above
/// rounding.
inline constexpr double constraint_compliance = 1e-12;

using Sparse = Eigen::SparseMatrix<double>;

/// A second variation K, the norm S of its eigenvalues, and what borders them: the pivots of
///     (K - mu S   C^T)
///     (C          -D )
/// tell the number of eigenvalues below mu on what the constraints C leave (D tends to 0), and of
/// K + C^T D^-1 C, by Sylvester's law of inertia. The unknowns come in the order of a band.
struct ConstrainedPencil {
  Sparse second;  ///< K
  Sparse norm;    ///< S
  Sparse fixed;   ///< C and D
  int borders;    ///< rows of C
};

/// The smallest eigenvalue of a pencil, and how many there are below zero and about it.
struct SmallestMode {
  int negative = 0;  ///< below -neutral_eigenvalue; -1: undetermined by the pivots
  int neutral = 0;   ///< closer to zero
  double smallest = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd x;  ///< its eigenvector; empty if the iteration did not find it
};

/// @param quotient  of a vector of norm 1, K + C^T D^-1 C where D does not tend to 0
[[nodiscard]] SmallestMode smallest_mode(
    const ConstrainedPencil& pencil, const std::function<double(const Eigen::VectorXd&)>& quotient);

}  // namespace dlo::energy_model
