// Tests of both solvers against published or independent numbers: see
// data/reference/reference_values.json.

#include <gsl/gsl_sf_airy.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using nlohmann::json;

constexpr double tolerance = 1e-8;  // divided by l, or by EI/l for energies of order one

Equilibrium solve(const Problem& problem, bool exact) {
  return exact ? solve_exact(problem) : solve_energy(problem);
}

class ReferenceValues : public testing::TestWithParam<bool> {};

TEST_P(ReferenceValues, OfACantileverWithATipLoad) {
  const json values = reference_values().at("tip_load").at("values");
  ASSERT_FALSE(values.empty());
  for (const auto& [load, expected] : values.items()) {
    Problem problem = heavy_cantilever(0, 0);
    problem.loads = {{1.0, {0, -std::stod(load), 0}}};
    const Equilibrium result = test::require_usable(solve(problem, GetParam()));
    const Samples samples = test::sample_at(result, 1);
    EXPECT_NEAR(samples.points(0, 0), expected.at("x_over_L"), tolerance) << load;
    EXPECT_NEAR(samples.points(1, 0), expected.at("y_over_L"), tolerance) << load;
    EXPECT_NEAR(-std::atan2(samples.tangents(1, 0), samples.tangents(0, 0)),
                expected.at("theta_tip_rad"), tolerance)
        << load;
  }
}

TEST_P(ReferenceValues, OfMattiassonsPrintedTable) {
  const json printed = reference_values().at("tip_load").at("printed");
  for (const auto& [load, expected] : printed.items()) {
    if (!expected.is_array()) continue;
    Problem problem = heavy_cantilever(0, 0);
    problem.loads = {{1.0, {0, -std::stod(load), 0}}};
    const Samples samples = test::sample_at(solve(problem, GetParam()), 1);
    EXPECT_NEAR(-samples.points(1, 0), expected[0], 5e-6) << load;
    EXPECT_NEAR(1 - samples.points(0, 0), expected[1], 5e-6) << load;
  }
}

TEST_P(ReferenceValues, OfHeavyCantilevers) {
  const json values = reference_values().at("heavy_cantilever");
  ASSERT_EQ(values.size(), 12U);
  for (const auto& [name, expected] : values.items()) {
    double gamma = 0;
    double degrees = 0;
    ASSERT_EQ(std::sscanf(name.c_str(), "Gamma=%lf,phi0=%lf", &gamma, &degrees), 2) << name;
    const Equilibrium result =
        test::require_usable(solve(heavy_cantilever(gamma, degrees), GetParam()));
    const Samples samples = test::sample_at(result, 1);
    EXPECT_NEAR(samples.points(0, 0), expected.at("tip_x"), tolerance) << name;
    EXPECT_NEAR(samples.points(1, 0), expected.at("tip_y"), tolerance) << name;
    EXPECT_NEAR(std::atan2(samples.tangents(1, 0), samples.tangents(0, 0)),
                expected.at("tip_angle_rad"), tolerance)
        << name;
    EXPECT_NEAR(result.energy.bending, expected.at("bending_energy"), tolerance) << name;
    EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy"), tolerance) << name;
  }
}

TEST_P(ReferenceValues, OfThePapersRod) {
  const json values = reference_values().at("paper_rod");
  ASSERT_EQ(values.size(), 3U);
  for (const auto& [name, expected] : values.items()) {
    Problem problem = heavy_cantilever(0, expected.at("clamp_deg").get<double>());
    problem.length = 0.5;
    problem.bending_stiffness = expected.at("EI").get<double>();
    problem.weight_per_length.y() =
        -expected.at("Gamma").get<double>() * problem.bending_stiffness / 0.125;
    const Equilibrium result = test::require_usable(solve(problem, GetParam()));
    const auto s = expected.at("s_m").get<std::vector<double>>();
    const auto x = expected.at("x_m").get<std::vector<double>>();
    const auto y = expected.at("y_m").get<std::vector<double>>();
    const Samples samples = result.sample(s);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(samples.points(0, column), x[i], tolerance * 0.5) << name << " s = " << s[i];
      EXPECT_NEAR(samples.points(1, column), y[i], tolerance * 0.5) << name << " s = " << s[i];
    }
  }
}

TEST_P(ReferenceValues, OfTwoClamps) {
  const json expected = reference_values().at("two_clamps").at("Gamma=10, lowest state");
  const Equilibrium result = test::converged(solve(test::two_clamps(10, 0.8), GetParam()));
  const double finer = GetParam() ? 0.01 : 1;  // shooting is
  EXPECT_NEAR(test::point_at(result, 0.5).y(), expected.at("y_mid"), GetParam() ? 1e-11 : 1e-8);
  EXPECT_NEAR(result.energy.bending, expected.at("bending_energy"), finer * tolerance);
  EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy"), finer * tolerance);
  EXPECT_NEAR(result.energy.total(), expected.at("total_energy"), tolerance);
  const double of_forces = GetParam() ? 1e-9 : 1e-6;
  EXPECT_NEAR(result.grips[1].force.x(), expected.at("lambda_x"), of_forces);
  EXPECT_NEAR(result.grips[1].force.y(), expected.at("lambda_y"), of_forces);
  const char* moments[] = {"clamp_moment_0", "clamp_moment_L"};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::abs(result.grips[i].torque.z()),
                std::abs(expected.at(moments[i]).get<double>()), of_forces);
  }
}

TEST_P(ReferenceValues, OfACantileverInSpace) {
  const json expected = reference_values().at("spatial_cantilever").at("tip P=(0,0,1), Gamma=1");
  Problem problem = heavy_cantilever(1, 0);
  problem.loads = {{1.0, {0, 0, 1}}};
  const Equilibrium result = test::converged(solve(problem, GetParam()));
  const Samples tip = test::sample_at(result, 1);
  const double bound = GetParam() ? 1e-10 : 1e-8;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_NEAR(tip.points(i, 0), expected.at("tip")[k], bound);
    EXPECT_NEAR(tip.tangents(i, 0), expected.at("tip_tangent")[k], bound);
  }
  EXPECT_NEAR(result.energy.bending, expected.at("bending_energy"), bound);
  EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy"), bound);
}

INSTANTIATE_TEST_SUITE_P(Solvers, ReferenceValues, testing::Values(false, true),
                         [](const auto& instance) { return instance.param ? "exact" : "energy"; });

TEST(SelfBuckling, IsTheRootOfTheAiryFunctions) {
  // The slope of the sum there is 1.67, so that z^3 is right to 1e-12.
  const double z = std::cbrt(test::self_buckling_gamma);
  EXPECT_NEAR(
      std::sqrt(3.0) * gsl_sf_airy_Ai(-z, GSL_PREC_DOUBLE) + gsl_sf_airy_Bi(-z, GSL_PREC_DOUBLE), 0,
      1e-13);
}

}  // namespace
}  // namespace dlo::energy_model
