#pragma once

#include <Eigen/Core>

namespace dlo::compare {

/// argmin |A x - b| over x >= 0, by the active set method of Lawson and Hanson (Solving Least
/// Squares Problems, 1974, chapter 23): columns come in, the one whose growth lowers the sum of
/// squares fastest first, and those that would become negative go out again. Of several solutions
/// one with linearly independent columns.
/// @return x, as long as A has columns
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& A,
                                                        const Eigen::VectorXd& b);

}  // namespace dlo::compare
