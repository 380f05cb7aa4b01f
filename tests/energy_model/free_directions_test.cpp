#include "linear/free_directions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "free_basis.hpp"
#include "with_eigenvalues.hpp"

namespace dlo::energy_model {
namespace {

using test::with_eigenvalues;

Eigen::VectorXd smallest_eigenvalues(const Eigen::MatrixXd& hessian,
                                     const Eigen::MatrixXd& jacobian) {
  ReducedHessian free;
  free.compute(hessian, jacobian);
  return energy_model::smallest_eigenvalues(free, 0);
}

double smallest_eigenvalue(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian) {
  return smallest_eigenvalues(hessian, jacobian)[0];
}

TEST(FreeDirections, SmallestEigenvalueIsTheSmallestWhateverItsSign) {
  for (const double smallest : {1e-3, 0.2, 0.999, 1.0, 1e-9, 0.0, -1e-3, -4.0}) {
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(24, 1, 3);
    eigenvalues[0] = smallest;
    const double found = smallest_eigenvalue(with_eigenvalues(eigenvalues), Eigen::MatrixXd(0, 24));
    // Among eigenvalues that are hardly larger, the proven accuracy is a hundredth.
    EXPECT_NEAR(found, smallest, (smallest < 0.5 ? 1e-3 : 1e-2) * std::abs(smallest) + 1e-13);
  }
}

TEST(FreeDirections, OnlyWhatConstraintsLeaveFreeIsAsked) {
  for (const Eigen::Index constraints : {1, 3, 6}) {
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(constraints, 16);
    const Eigen::MatrixXd hessian =
        with_eigenvalues(Eigen::VectorXd::LinSpaced(16, constraints == 3 ? -1 : 0.1, 2));
    const Eigen::MatrixXd Z = test::free_basis(jacobian, 16);
    EXPECT_LT((jacobian * Z).norm(), 1e-13);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Z.transpose() * hessian * Z);
    const double smallest = eigen.eigenvalues()[0];
    // The proven accuracy is a hundredth.
    EXPECT_NEAR(smallest_eigenvalue(hessian, jacobian), smallest, 1e-2 * std::abs(smallest));
  }
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_EQ(smallest_eigenvalues(all, all).size(), 0);
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
  EXPECT_NEAR(smallest_eigenvalue(hessian, Eigen::MatrixXd(0, 6)), 0.1, 1e-4);
}

// The vectors of the iteration become short among such, and have to stay orthogonal.
TEST(FreeDirections, SmallestEigenvalueOfManyThatAreHardlyLargerIsNoneBelowThem) {
  for (const double largest : {1.003, 1.03, 1.3}) {
    const Eigen::MatrixXd hessian = with_eigenvalues(Eigen::VectorXd::LinSpaced(60, 1, largest));
    EXPECT_NEAR(smallest_eigenvalue(hessian, Eigen::MatrixXd(0, 60)), 1, 1e-2) << largest;
  }
}

TEST(FreeDirections, AllEigenvaluesAreToldWhereTheSmallestIsNotAbove) {
  const Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(12, 0.1, 2);
  ReducedHessian free;
  free.compute(with_eigenvalues(eigenvalues), Eigen::MatrixXd(0, 12));
  EXPECT_EQ(energy_model::smallest_eigenvalues(free, 0.05).size(), 1);
  EXPECT_LT((energy_model::smallest_eigenvalues(free, 0.2) - eigenvalues).norm(), 1e-13);
}

TEST(FreeDirections, EigenvectorNearestZeroIsThatOnWhatIsFree) {
  constexpr Eigen::Index n = 40;
  for (const Eigen::Index m : {0, 5}) {
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(n, 0.5, 3);
    eigenvalues[0] = 1e-3;
    const Eigen::MatrixXd hessian = with_eigenvalues(eigenvalues);
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(m, n);
    ReducedHessian free;
    free.compute(hessian, jacobian);
    const std::optional<Eigen::VectorXd> softest = free.lowest_mode_of_definite();
    ASSERT_TRUE(softest);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(free.matrix());
    // The error is the residual divided by the distance to the next eigenvalue.
    EXPECT_NEAR(std::abs(softest->dot(eigen.eigenvectors().col(0))), 1, 1e-9) << m;
    EXPECT_NEAR(softest->norm(), 1, 1e-12);
    EXPECT_LT((jacobian * direction_by_size(free, 0)).norm(), 1e-12);
  }
  ReducedHessian saddle;
  saddle.compute(with_eigenvalues(Eigen::VectorXd::LinSpaced(8, -0.1, 2)), Eigen::MatrixXd(0, 8));
  EXPECT_FALSE(saddle.lowest_mode_of_definite());
}

TEST(FreeDirections, StepIsThatOfTheWholeSystem) {
  constexpr Eigen::Index n = 16;
  for (const Eigen::Index m : {0, 1, 5, 16}) {
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(m, n);
    const Eigen::MatrixXd hessian = with_eigenvalues(Eigen::VectorXd::LinSpaced(n, 0.1, 2));
    const Eigen::VectorXd right = Eigen::VectorXd::Random(n + m);
    ReducedHessian free;
    free.compute(hessian, jacobian);
    ASSERT_TRUE(free.has_solutions());
    Eigen::VectorXd step;
    free.solve(right, step);
    Eigen::MatrixXd system(n + m, n + m);
    system << hessian, -jacobian.transpose(), jacobian, Eigen::MatrixXd::Zero(m, m);
    EXPECT_LT((step - system.partialPivLu().solve(right)).norm(), 1e-10 * step.norm()) << m;
  }
}

TEST(FreeDirections, NoStepWithoutMinimumOrWithDependentConstraints) {
  ReducedHessian free;
  free.compute(with_eigenvalues(Eigen::VectorXd::LinSpaced(8, -0.1, 2)), Eigen::MatrixXd(0, 8));
  EXPECT_FALSE(free.has_solutions());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(3, 8);
  jacobian.row(2) = jacobian.row(0) - jacobian.row(1);
  free.compute(Eigen::MatrixXd::Identity(8, 8), jacobian);
  EXPECT_FALSE(free.has_solutions());
  free.compute(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Random(3, 2));
  EXPECT_FALSE(free.has_solutions());
}

}  // namespace
}  // namespace dlo::energy_model
