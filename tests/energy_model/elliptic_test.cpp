// Elliptic integrals against published numbers and against both solvers.

#include "elliptic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using nlohmann::json;
using std::numbers::pi;
using test::heavy_cantilever;
using test::reference_values;

TEST(TipDeflection, MatchesTheReferenceValues) {
  const json values = reference_values().at("tip_load").at("values");
  ASSERT_EQ(values.size(), 4U);
  for (const auto& [load, expected] : values.items()) {
    const TipDeflection result = tip_deflection(std::stod(load), -pi / 2);
    EXPECT_NEAR(result.tip.x(), expected.at("x_over_L"), 1e-13) << load;
    EXPECT_NEAR(result.tip.y(), expected.at("y_over_L"), 1e-13) << load;
    EXPECT_NEAR(-result.tip_angle, expected.at("theta_tip_rad"), 1e-13) << load;
  }
}

TEST(TipDeflection, MatchesMattiassonsPrintedTable) {
  const json printed = reference_values().at("tip_load").at("printed");
  for (const auto& [load, expected] : printed.items()) {
    if (!expected.is_array()) continue;
    const TipDeflection result = tip_deflection(std::stod(load), -pi / 2);
    EXPECT_NEAR(-result.tip.y(), expected[0], 5e-6) << load;
    EXPECT_NEAR(1 - result.tip.x(), expected[1], 5e-6) << load;
  }
}

TEST(TipDeflection, AgreesWithBothSolversForEveryDirectionOfTheForce) {
  const std::vector<double> tip = {1.0};
  for (const double load : {0.1, 10.0, 1000.0}) {
    for (int degrees = -165; degrees < 180; degrees += 30) {
      const double angle = degrees * pi / 180;
      const TipDeflection expected = tip_deflection(load, angle);
      Problem problem = heavy_cantilever(0, 0);
      problem.loads = {{1.0, {load * std::cos(angle), load * std::sin(angle), 0}}};
      for (const Equilibrium& result : {solve_energy(problem), solve_exact(problem)}) {
        ASSERT_TRUE(succeeded(result.status)) << load << ", " << degrees;
        const Samples samples = result.sample(tip);
        EXPECT_LT((samples.points.col(0).head<2>() - expected.tip).norm(), 1e-9)
            << load << ", " << degrees;
        EXPECT_NEAR(samples.tangents(0, 0), std::cos(expected.tip_angle), 1e-8);
        EXPECT_NEAR(samples.tangents(1, 0), std::sin(expected.tip_angle), 1e-8);
        EXPECT_NEAR(result.grips[0].torque.z(), -expected.clamp_curvature, 1e-7 * std::sqrt(load));
        EXPECT_NEAR(result.energy.bending, expected.bending_energy, 1e-8 * (1 + load));
      }
    }
  }
}

TEST(TipDeflection, IsInBalanceAtAnyLoad) {
  // The clamp's moment is the force's about the clamp, kappa_0 = x P sin(a) - y P cos(a), and
  // kappa_0^2 / 2 = P (cos(theta_tip - a) - cos(a)), the rod's first integral.
  for (const double load : {1e-8, 1e-3, 1.0, 300.0, 4e4}) {
    for (const double angle : {0.3, 1.2, 2.5, 3.1, -0.3, -3.0}) {
      const TipDeflection result = tip_deflection(load, angle);
      const double moment =
          load * (result.tip.x() * std::sin(angle) - result.tip.y() * std::cos(angle));
      EXPECT_NEAR(result.clamp_curvature, moment, 1e-12 * load) << load << ", " << angle;
      EXPECT_NEAR(result.clamp_curvature * result.clamp_curvature / 2,
                  load * (std::cos(result.tip_angle - angle) - std::cos(angle)), 1e-13 * load);
    }
  }
}

TEST(TipDeflection, BucklesBeyondEulersLoadOnly) {
  const double euler = pi * pi / 4;
  EXPECT_EQ(tip_deflection(euler * 0.999, pi).tip, Eigen::Vector2d(1, 0));
  // Post-buckling: P / P_E = 1 + a^2 / 8 with a the tip's angle, to fourth order in it
  const TipDeflection buckled = tip_deflection(euler * 1.001, pi);
  EXPECT_NEAR(buckled.tip_angle, std::sqrt(0.008), 1e-4);
  EXPECT_GT(buckled.tip.y(), 0);
  EXPECT_EQ(tip_deflection(1000, 0).tip, Eigen::Vector2d(1, 0));
}

}  // namespace
}  // namespace dlo::energy_model
