// Tests of rods of several sections by multiple shooting, against a stepped column's buckling load
// and two springs in series.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

TEST(ExactSections, AColumnOfTwoStiffnessesBucklesUnderItsLoad) {
  // Linear theory: tan(k a) tan(q b) = q / k, k = P^(1/2), q = (P / stiffness)^(1/2).
  constexpr double step = 0.4;
  constexpr double stiffness = 0.25;
  const auto miss = [&](double load) {
    const double k = std::sqrt(load);
    const double q = std::sqrt(load / stiffness);
    return std::sin(k * step) * std::sin(q * (1 - step)) * k -
           q * std::cos(k * step) * std::cos(q * (1 - step));
  };
  double low = 0.1;
  double high = pi * pi / 4;
  ASSERT_LT(miss(low) * miss(high), 0);
  while (high - low > 1e-14) {
    const double middle = (low + high) / 2;
    (miss(low) * miss(middle) > 0 ? low : high) = middle;
  }
  const auto column = [&](double load) {
    Problem problem = heavy_cantilever(0, 0);
    problem.sections = {{step, 1, stiffness, 0, Eigen::Vector3d::Zero()}};
    problem.loads = {{1, {-load, 0, 0}}};
    return problem;
  };
  const Equilibrium straight = solve_exact(column(low * (1 - 1e-5)));
  ASSERT_LT(straight.energy.bending, 1e-12);
  const double below = straight.smallest_eigenvalue;
  const double above =
      solve_exact(column(low * (1 + 1e-5)), {.start = &straight}).smallest_eigenvalue;
  EXPECT_GT(below, 0);
  EXPECT_LT(above, 0);
  EXPECT_NEAR(below / above, -1, 1e-3);  // the zero is in the middle
}

TEST(ExactSections, ATautRodOfTwoTorsionalStiffnessesTwistsAsTwoSprings) {
  Problem problem = heavy_cantilever(0, 0);
  problem.torsional_stiffness = 0.5;
  problem.grips.push_back({1, {1 - 1e-3, 0, 0}, Eigen::Vector3d(1, 0, 0)});
  problem.sections = {{0.3, 0.6, 1, 2, Eigen::Vector3d::Zero()}};
  for (Grip& grip : problem.grips) grip.frame = FrameHold{};
  problem.grips[1].frame->roll = 0.3;
  const Equilibrium result = test::converged(solve_exact(problem));
  ASSERT_EQ(result.twists.size(), 1U);
  const double compliance = 0.7 / 0.5 + 0.3 / 2;
  EXPECT_NEAR(result.twists[0].angle, compliance * result.twists[0].torque, 1e-12);
  EXPECT_NEAR(result.energy.twisting, compliance * std::pow(result.twists[0].torque, 2) / 2, 1e-12);
}

}  // namespace
}  // namespace dlo::energy_model
