#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <limits>

namespace dlo::energy_model {

/// Size of an eigenvalue of a second variation below which it counts as zero [-].
inline constexpr double neutral_eigenvalue = 1e-7;

/// Weight of the constraints' own block: far below the influence of the constraints (1 / |C|^2),
/// far above rounding.
inline constexpr double constraint_compliance = 1e-12;

using Sparse = Eigen::SparseMatrix<double>;

/// A second variation K, the norm S of its eigenvalues, and the constraints that border them. The
/// pivots of
///     (K - mu S   C^T)
///     (C          -D )
/// give the number of eigenvalues below mu: of K in the directions that the constraints C leave
/// free (if D tends to 0), and of K + C^T D^-1 C, by Sylvester's law of inertia. The unknowns are
/// ordered as in a band matrix.
struct ConstrainedPencil {
  Sparse second;             ///< K
  Sparse norm;               ///< S
  Sparse constraint_blocks;  ///< blocks of C, C^T and -D
  int constraint_count;      ///< number of rows of C
};

/// Smallest eigenvalue of a pencil, and numbers of negative and of zero eigenvalues.
struct SmallestMode {
  /// Number of eigenvalues below -neutral_eigenvalue; -1: undetermined by the pivots.
  int negative = 0;
  int neutral = 0;  ///< number of eigenvalues between -neutral_eigenvalue and neutral_eigenvalue
  double smallest = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd x;  ///< eigenvector of the smallest one; empty if the iteration did not find it
};

/// Computes the smallest eigenvalue of a pencil.
/// @param quotient  returns the value of the second variation for a vector of norm 1; of K + C^T
///                  D^-1 C if D does not tend to 0
[[nodiscard]] SmallestMode smallest_mode(
    const ConstrainedPencil& pencil, const std::function<double(const Eigen::VectorXd&)>& quotient);

}  // namespace dlo::energy_model
