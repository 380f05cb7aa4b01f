#pragma once

#include <Eigen/Core>

#include "helpers.hpp"

namespace dlo::test {

/// Returns the central differences of a vector that is a function of a matrix, with steps of h: a
/// column for each number of the matrix `at`.
template <typename Vector, typename Matrix>
Eigen::MatrixXd difference_matrix(const Vector& vector, Matrix at, double h) {
  Eigen::MatrixXd result;
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    const double x = at.data()[k];
    at.data()[k] = x + h;
    const Eigen::VectorXd above = vector(at);
    at.data()[k] = x - h;
    const Eigen::VectorXd below = vector(at);
    at.data()[k] = x;
    result.conservativeResize(above.size(), k + 1);
    result.col(k) = (above - below) / (2 * h);
  }
  return result;
}

/// Returns the central differences of a number that is a function of a matrix, with steps of h, in
/// a matrix like `at`.
template <typename Number, typename Matrix>
Matrix difference_gradient(const Number& number, Matrix at, double h) {
  const auto vector = [&](const Matrix& x) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(1, number(x));
  };
  at.reshaped() = difference_matrix(vector, at, h).transpose();
  return at;
}

}  // namespace dlo::test
