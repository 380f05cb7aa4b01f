#include <gtest/gtest.h>

#include <cmath>

#include "linear/reduced_hessian.hpp"
#include "with_eigenvalues.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the smallest eigenvalue of a Hessian without constraints.
double smallest_without_constraints(const Eigen::MatrixXd& hessian) {
  ReducedHessian free;
  free.compute(hessian, Eigen::MatrixXd(0, hessian.rows()));
  return smallest_eigenvalues(free, 0)[0];
}

TEST(FreeDirections, SmallestEigenvalueIsTheSmallestWhateverItsSign) {
  for (const double smallest : {1e-3, 0.2, 0.999, 1.0, 1e-9, 0.0, -1e-3, -4.0}) {
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(24, 1, 3);
    eigenvalues[0] = smallest;
    const double found = smallest_without_constraints(with_eigenvalues(eigenvalues));
    // Among eigenvalues that are hardly larger, the proven accuracy is a hundredth.
    EXPECT_NEAR(found, smallest, (smallest < 0.5 ? 1e-3 : 1e-2) * std::abs(smallest) + 1e-13);
  }
}

/// If the initial vector of the iteration has no component along the first eigenvector, it finds
/// another eigenvalue, which the proof refuses.
TEST(FreeDirections, SmallestEigenvalueIsProven) {
  Eigen::VectorXd seed(6);
  for (Eigen::Index i = 0; i < 6; ++i) seed[i] = std::sin(1 + 1.7 * static_cast<double>(i));
  seed.normalize();
  Eigen::VectorXd across = Eigen::VectorXd::Unit(6, 2);
  across = (across - across.dot(seed) * seed).normalized();
  const Eigen::MatrixXd hessian =
      Eigen::MatrixXd::Identity(6, 6) - 0.9 * across * across.transpose();
  EXPECT_NEAR(smallest_without_constraints(hessian), 0.1, 1e-4);
}

// If many eigenvalues are close, the vectors of the iteration become short and have to be kept
// orthogonal.
TEST(FreeDirections, SmallestOfManyCloseEigenvaluesIsNotTooLow) {
  for (const double largest : {1.003, 1.03, 1.3}) {
    const Eigen::MatrixXd hessian = with_eigenvalues(Eigen::VectorXd::LinSpaced(60, 1, largest));
    EXPECT_NEAR(smallest_without_constraints(hessian), 1, 1e-2) << largest;
  }
}

}  // namespace
}  // namespace dlo::energy_model
