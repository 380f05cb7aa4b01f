#include "linear/free_directions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "free_basis.hpp"

namespace dlo::energy_model {
namespace {

/// A symmetric matrix with these eigenvalues.
Eigen::MatrixXd with_eigenvalues(const Eigen::VectorXd& eigenvalues) {
  const Eigen::Index n = eigenvalues.size();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd::Random(n, n));
  const Eigen::MatrixXd Q = qr.householderQ();
  return Q * eigenvalues.asDiagonal() * Q.transpose();
}

Eigen::VectorXd smallest_eigenvalues(const Eigen::MatrixXd& hessian,
                                     const Eigen::MatrixXd& jacobian) {
  FreeHessian free;
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
    // Among others that are hardly larger, a hundredth is what is proven.
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
    // A hundredth is what is proven.
    EXPECT_NEAR(smallest_eigenvalue(hessian, jacobian), smallest, 1e-2 * std::abs(smallest));
  }
  const Eigen::MatrixXd all = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_EQ(smallest_eigenvalues(all, all).size(), 0);
}

/// A seed of the iteration that has nothing of the softest direction finds another eigenvalue,
/// which the proof refuses.
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
  FreeHessian free;
  free.compute(with_eigenvalues(eigenvalues), Eigen::MatrixXd(0, 12));
  EXPECT_EQ(energy_model::smallest_eigenvalues(free, 0.05).size(), 1);
  EXPECT_LT((energy_model::smallest_eigenvalues(free, 0.2) - eigenvalues).norm(), 1e-13);
}

/// Moré and Sorensen: (H + mu) z = b with H + mu positive semidefinite and |z| = length, or mu = 0
/// and z shorter, is the minimum of z.H z / 2 - b.z within this length.
TEST(FreeDirections, StepWithinALengthIsTheLowestThere) {
  constexpr Eigen::Index n = 24;
  for (const double smallest : {0.5, 1e-3, 0.0, -0.1, -3.0}) {
    for (const double length : {1e-3, 0.1, 2.0, 50.0}) {
      for (const double pulled_along_it : {1.0, 1e-9, 0.0}) {
        Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(n, 0.7, 4);
        eigenvalues[0] = smallest;
        const Eigen::MatrixXd hessian = with_eigenvalues(eigenvalues);
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
        const Eigen::VectorXd soft = eigen.eigenvectors().col(0);
        Eigen::VectorXd right = Eigen::VectorXd::Random(n);
        right += (pulled_along_it - 1) * right.dot(soft) * soft;
        FreeHessian free;
        free.compute(hessian, Eigen::MatrixXd(0, n));
        Eigen::VectorXd z = right;
        // Without a mu it is for who asks to know whether Newton's step is within.
        if (free.is_definite()) {
          free.solve_free(z);
          if (z.norm() <= length) continue;
          z = right;
        }
        ASSERT_TRUE(free.solve_within(length, z))
            << smallest << ' ' << length << ' ' << pulled_along_it;
        EXPECT_LE(z.norm(), 1.011 * length);
        EXPECT_GE(z.norm(), 0.74 * length);
        // The lowest on the sphere of its own length, by eigenvalues and bisection.
        const Eigen::VectorXd pull = eigen.eigenvectors().transpose() * right;
        double low = std::max(0.0, -smallest);
        double high = low + right.norm() / z.norm();
        const auto step = [&](double mu) {
          return Eigen::VectorXd(pull.array() / (eigenvalues.array() + mu).max(1e-300));
        };
        for (int i = 0; i < 200; ++i) {
          const double middle = (low + high) / 2;
          (step(middle).norm() > z.norm() ? low : high) = middle;
        }
        Eigen::VectorXd lowest = step(high);
        // What mu cannot tell for rounding, where nothing pulls along the smallest one.
        const double others = lowest.tail(n - 1).squaredNorm();
        lowest[0] = std::copysign(std::sqrt(std::max(0.0, z.squaredNorm() - others)), lowest[0]);
        const double wanted = lowest.dot(eigenvalues.cwiseProduct(lowest)) / 2 - pull.dot(lowest);
        const double found = z.dot(hessian * z) / 2 - right.dot(z);
        // mu is known to rounding, but to the hundredth at which its bounds are one another where
        // what pulls along the smallest one does not set it that far from there.
        const double rounding = 1e-9 * (1 + std::abs(wanted));
        const bool told = std::abs(pull[0]) > 2e-2 * high * z.norm();
        const double unknown = told ? 0 : 1e-2 * high;
        EXPECT_GE(found, wanted - rounding);
        EXPECT_LE(found, wanted + rounding + unknown * z.squaredNorm() / 2)
            << smallest << ' ' << length << ' ' << pulled_along_it;
      }
    }
  }
}

TEST(FreeDirections, EigenvectorNearestZeroIsThatOnWhatIsFree) {
  constexpr Eigen::Index n = 40;
  for (const Eigen::Index m : {0, 5}) {
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(n, 0.5, 3);
    eigenvalues[0] = 1e-3;
    const Eigen::MatrixXd hessian = with_eigenvalues(eigenvalues);
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(m, n);
    FreeHessian free;
    free.compute(hessian, jacobian);
    const std::optional<Eigen::VectorXd> softest = free.softest_of_definite();
    ASSERT_TRUE(softest);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(free.matrix());
    // As near as the residual over the distance to the next eigenvalue.
    EXPECT_NEAR(std::abs(softest->dot(eigen.eigenvectors().col(0))), 1, 1e-9) << m;
    EXPECT_NEAR(softest->norm(), 1, 1e-12);
    EXPECT_LT((jacobian * direction_by_size(free, 0)).norm(), 1e-12);
  }
  FreeHessian saddle;
  saddle.compute(with_eigenvalues(Eigen::VectorXd::LinSpaced(8, -0.1, 2)), Eigen::MatrixXd(0, 8));
  EXPECT_FALSE(saddle.softest_of_definite());
}

TEST(FreeDirections, StepIsThatOfTheWholeSystem) {
  constexpr Eigen::Index n = 16;
  for (const Eigen::Index m : {0, 1, 5, 16}) {
    const Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(m, n);
    const Eigen::MatrixXd hessian = with_eigenvalues(Eigen::VectorXd::LinSpaced(n, 0.1, 2));
    const Eigen::VectorXd right = Eigen::VectorXd::Random(n + m);
    FreeHessian free;
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
  FreeHessian free;
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
