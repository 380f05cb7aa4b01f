#include "judge/nonnegative_least_squares.hpp"

#include <gtest/gtest.h>

#include <random>

namespace dlo::compare {
namespace {

/// What a minimum over x >= 0 has: no slope where x is free, none downwards where it is zero.
void expect_optimal(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  const Eigen::VectorXd slope = A.transpose() * (b - A * x);
  const double scale = A.norm() * b.norm();
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    EXPECT_GE(x[j], 0);
    EXPECT_LE(slope[j], 1e-10 * scale) << j;
    if (x[j] > 0) {
      EXPECT_NEAR(slope[j], 0, 1e-10 * scale) << j;
    }
  }
}

TEST(NonnegativeLeastSquares, MeetsTheConditionsOfAMinimum) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const int columns : {1, 5, 20, 60}) {
    for (int draw = 0; draw < 10; ++draw) {
      const Eigen::MatrixXd A =
          Eigen::MatrixXd::NullaryExpr(20, columns, [&] { return normal(random); });
      const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(20, [&] { return normal(random); });
      expect_optimal(A, b, nonnegative_least_squares(A, b));
    }
  }
}

TEST(NonnegativeLeastSquares, TakesColumnsOfAllSizesThatDependOnEachOther) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd basis = Eigen::MatrixXd::NullaryExpr(15, 3, [&] { return normal(random); });
  Eigen::MatrixXd A = basis * Eigen::MatrixXd::NullaryExpr(3, 40, [&] { return normal(random); });
  A.leftCols(20) *= 1e-6;
  A.col(7).setZero();
  A.col(9) = A.col(8);
  const Eigen::VectorXd b = A.rightCols(20).rowwise().sum();
  const Eigen::VectorXd x = nonnegative_least_squares(A, b);
  expect_optimal(A, b, x);
  EXPECT_LT((A * x - b).norm(), 1e-10 * b.norm());
}

TEST(NonnegativeLeastSquares, IsZeroWhereEveryColumnPointsAway) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_EQ(nonnegative_least_squares(A, Eigen::Vector3d(-1, -2, -3)), Eigen::Vector3d::Zero());
  EXPECT_EQ(nonnegative_least_squares(A, Eigen::Vector3d(-1, 2, 0)), Eigen::Vector3d(0, 2, 0));
}

}  // namespace
}  // namespace dlo::compare
