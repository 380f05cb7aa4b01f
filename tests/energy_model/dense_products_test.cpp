#include "linear/dense_products.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "../says.hpp"

namespace dlo::energy_model {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Rounding of sums of up to fifty products of numbers up to one.
constexpr double rounding = 1e-13;

/// Returns the kernels of the instruction sets that this machine has.
std::vector<const DenseKernel*> available_kernels() {
  std::vector<const DenseKernel*> available;
  for (const char* name : {"baseline", "avx2", "avx512"}) {
    try {
      available.push_back(&dense_kernel_named(name));
    } catch (const std::invalid_argument&) {
      // This machine does not have the instruction set.
    }
  }
  return available;
}

const std::vector<const DenseKernel*> kernels = available_kernels();

TEST(DenseKernel, UnknownNameIsRefusedWithTheAvailableOnes) {
  EXPECT_TRUE(test::error_of<std::invalid_argument>([] { return &dense_kernel_named("sse9"); })
                  .starts_with("dense_kernel_named: DLO_INSTRUCTION_SET = sse9, must be one that "
                               "this machine has (baseline"));
}

// CMakeLists.txt runs this test with the name of each instruction set in the environment variable.
TEST(DenseKernel, IsThatOfTheEnvironmentVariableElseTheFastest) {
  const char* name = std::getenv("DLO_INSTRUCTION_SET");
  EXPECT_EQ(&dense_kernel(),
            name != nullptr && *name != '\0' ? &dense_kernel_named(name) : kernels.back());
}

/// Fills a matrix with random numbers. Returns a block of it, whose columns are not contiguous in
/// memory.
MatrixXd::BlockXpr part_of(MatrixXd& whole, Index rows, Index columns) {
  whole = MatrixXd::Random(rows + 3, columns + 2);
  return whole.block(2, 1, rows, columns);
}

TEST(DenseProducts, AreThoseOfTheLibraryInAllSizes) {
  for (const Index rows : {1, 2, 3, 4, 5, 8, 11, 15, 16, 20, 31, 32, 33, 47, 63, 64, 65, 130}) {
    for (const Index inner : {1, 2, 3, 7, 30}) {
      for (const Index columns : {1, 2, 3, 4, 5, 9}) {
        MatrixXd wholes[3];
        const auto a = part_of(wholes[0], rows, inner);
        const auto b = part_of(wholes[1], inner, columns);
        auto product = part_of(wholes[2], rows, columns);
        const MatrixXd around = wholes[2];
        for (const DenseKernel* kernel : kernels) {
          kernel->multiply(columns_of(a), columns_of(b), result_columns(product));
          EXPECT_LT((product - a * b).norm(), rounding) << rows << ' ' << inner << ' ' << columns;
          product = around.block(2, 1, rows, columns);
          EXPECT_EQ(wholes[2], around) << "written beside the result";
        }
      }
    }
  }
}

TEST(DenseProducts, ComputeSymmetricProducts) {
  for (const Index inner : {1, 3, 4, 9, 47}) {
    for (const Index n : {1, 2, 3, 4, 5, 7, 20}) {
      const MatrixXd a = MatrixXd::Random(n, inner);
      const Eigen::VectorXd weights = Eigen::VectorXd::Random(inner);
      const MatrixXd weighted = a * weights.asDiagonal();
      MatrixXd product(n, n);
      for (const DenseKernel* kernel : kernels) {
        kernel->multiply_symmetric(columns_of(a), columns_of(weighted), result_columns(product));
        EXPECT_LT((product - a * weighted.transpose()).norm(), rounding) << inner << ' ' << n;
      }
    }
  }
}

TEST(DenseProducts, FactorOnlyPositiveDefiniteMatrices) {
  for (const Index n : {1, 2, 3, 4, 5, 8, 9, 13, 20, 47}) {
    const MatrixXd root = MatrixXd::Random(n, n);
    const MatrixXd matrix = root * root.transpose() + MatrixXd::Identity(n, n);
    const Eigen::VectorXd right = Eigen::VectorXd::Random(n);
    const Index stride = (n + padding - 1) / padding * padding;
    for (const DenseKernel* kernel : kernels) {
      MatrixXd factor = MatrixXd::Zero(stride, n);
      factor.topRows(n) = matrix;
      ASSERT_TRUE(kernel->factor({factor.data(), n, n, stride})) << n;
      Eigen::VectorXd x = right;
      kernel->solve({factor.data(), n, n, stride}, x.data());
      EXPECT_LT((matrix * x - right).norm(), rounding) << n;
      factor.topRows(n) = matrix;
      factor(n - 1, n - 1) -= 1 / matrix.inverse()(n - 1, n - 1) + 1e-6;
      EXPECT_FALSE(kernel->factor({factor.data(), n, n, stride})) << n;
    }
  }
}

TEST(DenseProducts, ReflectOnBothSides) {
  for (const Index n : {1, 3, 8, 21}) {
    const MatrixXd half = MatrixXd::Random(n, n);
    const MatrixXd matrix = half + half.transpose();
    const Eigen::VectorXd v = Eigen::VectorXd::Random(n);
    const double tau = 2 / v.squaredNorm();
    const MatrixXd reflection = MatrixXd::Identity(n, n) - tau * v * v.transpose();
    for (const DenseKernel* kernel : kernels) {
      MatrixXd reflected = matrix;
      Eigen::VectorXd scratch(n);
      kernel->reflect(result_columns(reflected), v.data(), tau, scratch.data());
      EXPECT_LT((reflected - reflection * matrix * reflection).norm(), rounding) << n;
    }
  }
}

TEST(DenseProducts, TurnAnglesAsTheLibraryDoes) {
  // One and a half units in the last place of numbers up to one.
  constexpr double last_place = 1.7e-16;
  Eigen::VectorXd angles(203);
  for (Index i = 0; i < angles.size(); ++i) {
    const auto step = static_cast<double>(i - 101);
    angles[i] = i % 3 == 0 ? 0.1 * step : i % 3 == 1 ? 1e-9 * step : 9876.5 * step;
  }
  for (const Index count : {0, 1, 2, 3, 7, 8, 203}) {
    for (const DenseKernel* kernel : kernels) {
      Eigen::VectorXd cosines = Eigen::VectorXd::Constant(204, 2);
      Eigen::VectorXd sines = cosines;
      kernel->turn(angles.data(), count, cosines.data(), sines.data());
      for (Index i = 0; i < count; ++i) {
        EXPECT_NEAR(cosines[i], std::cos(angles[i]), last_place) << angles[i];
        EXPECT_NEAR(sines[i], std::sin(angles[i]), last_place) << angles[i];
      }
      EXPECT_EQ(cosines[count], 2);
      EXPECT_EQ(sines[count], 2);
    }
  }
}

Eigen::Quaterniond row_of(const Eigen::MatrixX4d& rows, Index r) {
  return {rows(r, 0), rows(r, 1), rows(r, 2), rows(r, 3)};
}

TEST(DenseProducts, AddWeighed) {
  for (const Index rows : {1, 3, 8, 20, 53}) {
    for (const Index n : {1, 2, 9}) {
      MatrixXd wholes[3];
      const auto a = part_of(wholes[0], rows, n);
      const auto b = part_of(wholes[1], rows, n);
      auto sum = part_of(wholes[2], rows, n);
      const MatrixXd left_of_a = MatrixXd::Random(rows, 3);
      const MatrixXd left_of_b = MatrixXd::Random(rows, 3);
      const MatrixXd right_of_a = MatrixXd::Random(n, 3);
      const MatrixXd right_of_b = MatrixXd::Random(n, 3);
      const MatrixXd wanted = a.cwiseProduct(left_of_a * right_of_a.transpose()) +
                              b.cwiseProduct(left_of_b * right_of_b.transpose());
      const MatrixXd around = wholes[2];
      for (const DenseKernel* kernel : kernels) {
        kernel->add_weighted_products(
            {columns_of(a), columns_of(left_of_a), columns_of(right_of_a)},
            {columns_of(b), columns_of(left_of_b), columns_of(right_of_b)}, result_columns(sum));
        EXPECT_LT((sum - wanted).norm(), rounding) << rows << ' ' << n;
        sum = around.block(2, 1, rows, n);
        EXPECT_EQ(wholes[2], around) << "written beside the result";
      }
    }
  }
}

class QuaternionRows : public ::testing::TestWithParam<const DenseKernel*> {};

TEST_P(QuaternionRows, AreMultipliedAsByTheLibrary) {
  for (const Index rows : {1, 3, 4, 6, 13}) {
    const Eigen::MatrixX4d q = Eigen::MatrixX4d::Random(rows, 4);
    const Eigen::MatrixX4d a = Eigen::MatrixX4d::Random(rows, 4);
    const Eigen::MatrixX3d u = Eigen::MatrixX3d::Random(rows, 3);
    Eigen::MatrixX4d by_strains(rows, 4);
    GetParam()->multiply_by_two_strains(columns_of(q), columns_of(u), 0.5,
                                        result_columns(by_strains));
    Eigen::MatrixX4d by_conjugate = a;
    GetParam()->multiply_by_conjugate(result_columns(by_conjugate), columns_of(q));
    Eigen::MatrixX4d turned = q;
    GetParam()->add_product(result_columns(turned), columns_of(a));
    for (Index r = 0; r < rows; ++r) {
      const Eigen::Quaterniond at = row_of(q, r);
      const Eigen::Quaterniond strain(0, u(r, 0) / 2, u(r, 1) / 2, 0);
      EXPECT_LT((row_of(by_strains, r).coeffs() - (at * strain).coeffs()).norm(), rounding);
      const Eigen::Quaterniond conjugate = row_of(a, r) * at.conjugate();
      EXPECT_LT((row_of(by_conjugate, r).coeffs() - conjugate.coeffs()).norm(), rounding);
      const Eigen::Vector4d sum = at.coeffs() + (row_of(a, r) * at).coeffs();
      EXPECT_LT((row_of(turned, r).coeffs() - sum.normalized()).norm(), rounding);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(DenseProducts, QuaternionRows, ::testing::ValuesIn(kernels));

}  // namespace
}  // namespace dlo::energy_model
