#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>

#include "linear/reduced_hessian.hpp"
#include "newton/trust_region.hpp"
#include "with_eigenvalues.hpp"

namespace dlo::energy_model {
namespace {

/// Moré and Sorensen: (H + mu) z = b with H + mu positive semidefinite and |z| = length, or mu = 0
/// and z shorter, is the minimum of z.H z / 2 - b.z within this length.
TEST(TrustRegionStep, IsTheLowestWithinTheRadius) {
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
        ReducedHessian free;
        free.compute(hessian, Eigen::MatrixXd(0, n));
        const std::optional<Eigen::VectorXd> step_within =
            trust_region_step(free, -right, {.radius = length});
        ASSERT_TRUE(step_within) << smallest << ' ' << length << ' ' << pulled_along_it;
        const Eigen::VectorXd& z = *step_within;
        // An eigenvalue of zero may be positive by rounding, and Newton's step within the radius.
        if (smallest >= 0 && z.norm() < 0.74 * length) {
          EXPECT_LT((hessian * z - right).norm(), 1e-9 * right.norm());
          continue;
        }
        EXPECT_LE(z.norm(), 1.011 * length);
        EXPECT_GE(z.norm(), 0.74 * length);
        // The minimum on the sphere through z, computed from all eigenvalues by bisection.
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
        // Rounding leaves this component undetermined by mu if no force acts along the smallest
        // eigenvector.
        const double others = lowest.tail(n - 1).squaredNorm();
        lowest[0] = std::copysign(std::sqrt(std::max(0.0, z.squaredNorm() - others)), lowest[0]);
        const double wanted = lowest.dot(eigenvalues.cwiseProduct(lowest)) / 2 - pull.dot(lowest);
        const double found = z.dot(hessian * z) / 2 - right.dot(z);
        // mu is known to rounding if the force along the smallest eigenvector is large enough.
        // Otherwise it is known to the hundredth at which the search for mu ends.
        const double rounding = 1e-9 * (1 + std::abs(wanted));
        const bool is_determined = std::abs(pull[0]) > 2e-2 * high * z.norm();
        const double unknown = is_determined ? 0 : 1e-2 * high;
        EXPECT_GE(found, wanted - rounding);
        EXPECT_LE(found, wanted + rounding + unknown * z.squaredNorm() / 2)
            << smallest << ' ' << length << ' ' << pulled_along_it;
      }
    }
  }
}

TEST(TrustRegionStep, WithoutAGradientOnlyNegativeCurvatureLeadsOn) {
  constexpr Eigen::Index n = 24;
  constexpr double radius = 0.5;
  const Eigen::VectorXd tiny = Eigen::VectorXd::Constant(n, 1e-9);
  const TrustRegion region = {.radius = radius, .gradient_tolerance = 1e-6};
  for (const double smallest : {1.0, 1e-9, -1e-9, -1e-6, -0.1, -30.0}) {
    Eigen::VectorXd eigenvalues = Eigen::VectorXd::LinSpaced(n, 0.7, 4);
    eigenvalues[0] = smallest;
    const Eigen::MatrixXd hessian = with_eigenvalues(eigenvalues);
    ReducedHessian free;
    free.compute(hessian, Eigen::MatrixXd(0, n));
    const std::optional<Eigen::VectorXd> step = trust_region_step(free, tiny, region);
    ASSERT_EQ(step.has_value(), smallest < -zero_eigenvalue_limit) << smallest;
    if (!step) continue;
    EXPECT_NEAR(step->norm(), radius, 0.26 * radius);
    EXPECT_LT(tiny.dot(*step) + step->dot(hessian * *step) / 2,
              0.9 * smallest * step->squaredNorm() / 2);
  }
}

TEST(TrustRegionStep, NoneWhereNewtonsIsShort) {
  const Eigen::VectorXd gradient = Eigen::VectorXd::Constant(4, 0.01);
  ReducedHessian free;
  free.compute(Eigen::MatrixXd::Identity(4, 4), Eigen::MatrixXd(0, 4));
  EXPECT_FALSE(trust_region_step(free, gradient, {.radius = 1, .least_step = 0.03}));
  EXPECT_TRUE(trust_region_step(free, gradient, {.radius = 1, .least_step = 0.01}));
}

}  // namespace
}  // namespace dlo::energy_model
