// Both solvers against numbers that were made elsewhere: see data/reference/reference_values.json.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using nlohmann::json;
using test::heavy_cantilever;
using test::reference_values;

constexpr double tolerance = 1e-8;  // of l, and of EI/l for energies of order one

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
    const Equilibrium result = solve(problem, GetParam());
    ASSERT_TRUE(succeeded(result.status)) << load;
    const std::vector<double> tip = {1.0};
    const Samples samples = result.sample(tip);
    EXPECT_NEAR(samples.points(0, 0), expected.at("x_over_L").get<double>(), tolerance) << load;
    EXPECT_NEAR(samples.points(1, 0), expected.at("y_over_L").get<double>(), tolerance) << load;
    EXPECT_NEAR(-std::atan2(samples.tangents(1, 0), samples.tangents(0, 0)),
                expected.at("theta_tip_rad").get<double>(), tolerance)
        << load;
  }
}

TEST_P(ReferenceValues, OfMattiassonsPrintedTable) {
  const json printed = reference_values().at("tip_load").at("printed");
  for (const auto& [load, expected] : printed.items()) {
    if (!expected.is_array()) continue;
    Problem problem = heavy_cantilever(0, 0);
    problem.loads = {{1.0, {0, -std::stod(load), 0}}};
    const std::vector<double> tip = {1.0};
    const Samples samples = solve(problem, GetParam()).sample(tip);
    EXPECT_NEAR(-samples.points(1, 0), expected[0].get<double>(), 5e-6) << load;
    EXPECT_NEAR(1 - samples.points(0, 0), expected[1].get<double>(), 5e-6) << load;
  }
}

TEST_P(ReferenceValues, OfHeavyCantilevers) {
  const json values = reference_values().at("heavy_cantilever");
  ASSERT_EQ(values.size(), 12U);
  for (const auto& [name, expected] : values.items()) {
    double gamma = 0;
    double degrees = 0;
    ASSERT_EQ(std::sscanf(name.c_str(), "Gamma=%lf,phi0=%lf", &gamma, &degrees), 2) << name;
    const Equilibrium result = solve(heavy_cantilever(gamma, degrees), GetParam());
    ASSERT_TRUE(succeeded(result.status)) << name;
    const std::vector<double> tip = {1.0};
    const Samples samples = result.sample(tip);
    EXPECT_NEAR(samples.points(0, 0), expected.at("tip_x").get<double>(), tolerance) << name;
    EXPECT_NEAR(samples.points(1, 0), expected.at("tip_y").get<double>(), tolerance) << name;
    EXPECT_NEAR(std::atan2(samples.tangents(1, 0), samples.tangents(0, 0)),
                expected.at("tip_angle_rad").get<double>(), tolerance)
        << name;
    EXPECT_NEAR(result.energy.bending, expected.at("bending_energy").get<double>(), tolerance)
        << name;
    EXPECT_NEAR(result.energy.gravity, expected.at("gravity_energy").get<double>(), tolerance)
        << name;
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
    const Equilibrium result = solve(problem, GetParam());
    ASSERT_TRUE(succeeded(result.status)) << name;
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

INSTANTIATE_TEST_SUITE_P(Solvers, ReferenceValues, testing::Values(false, true),
                         [](const auto& instance) { return instance.param ? "exact" : "energy"; });

TEST(SelfBuckling, IsTheRootOfTheAiryFunctions) {
  EXPECT_NEAR(self_buckling_gamma(), reference_values().at("self_buckling_Gamma").get<double>(),
              1e-12);
}

}  // namespace
}  // namespace dlo::energy_model
