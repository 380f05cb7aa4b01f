#include "dlo/energy_model/exact.hpp"

#include <gtest/gtest.h>

#include "problems.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

TEST(Exact, FollowsTheLinearTheoryForSmallLoads) {
  // Tip of a cantilever: w l^4 / (8 EI) under its weight, P a^2 (3 l - a) / (6 EI) under a load at
  // a
  const double small = 1e-4;
  EXPECT_NEAR(test::point_at(solve_exact(heavy_cantilever(small, 0)), 1).y(), -small / 8,
              small * small);
  Problem load = heavy_cantilever(0, 0);
  load.loads = {{0.5, {0, small, 0}}};
  EXPECT_NEAR(test::point_at(solve_exact(load), 1).y(), small * 0.25 * 2.5 / 6, small * small);
}

TEST(Exact, SatisfiesTheElasticaEverywhere) {
  // EI kappa' = -n x t with n the weight beyond s: checked with central differences of the samples
  const double gamma = 20;
  const Equilibrium result = solve_exact(heavy_cantilever(gamma, 35));
  const double h = 1e-4;
  for (const double s : {0.1, 0.4, 0.7, 0.95}) {
    const std::vector<double> around = {s - h, s, s + h};
    const Samples samples = result.sample(around);
    const auto signed_curvature = [&](Eigen::Index i) {
      return samples.tangents(0, i) * samples.curvature(1, i) -
             samples.tangents(1, i) * samples.curvature(0, i);
    };
    const double rate = (signed_curvature(2) - signed_curvature(0)) / (2 * h);
    const double n_y = -gamma * (1 - s);
    EXPECT_NEAR(rate, -samples.tangents(0, 1) * n_y, 1e-5 * gamma) << s;
  }
}

TEST(Exact, FindsTheSecondStableStateAboveTheFoldOnly) {
  const double fold = test::reference_values().at("bistability_fold_Gamma").at("0").get<double>();
  EXPECT_EQ(all_exact(heavy_cantilever(fold * 0.99, 0)).size(), 1U);
  const std::vector<Equilibrium> above = all_exact(heavy_cantilever(fold * 1.01, 0));
  ASSERT_EQ(above.size(), 3U);
  EXPECT_LT(above[0].energy.total(), above[1].energy.total());
}

TEST(Exact, UprightRodHasThreeEquilibriaAboveSelfBuckling) {
  EXPECT_EQ(all_exact(heavy_cantilever(7.8, 90)).size(), 1U);
  const std::vector<Equilibrium> above = all_exact(heavy_cantilever(8, 90));
  ASSERT_EQ(above.size(), 3U);
  EXPECT_NEAR(above[0].energy.total(), above[1].energy.total(), 1e-9);
  EXPECT_GT(test::point_at(above[0], 1).x(), 0);  // the one towards +x comes first
}

TEST(Exact, RefusesLoadsBeyondDoublePrecisionAndBadOptions) {
  EXPECT_THROW((void)solve_exact(heavy_cantilever(1e7, 0)), std::invalid_argument);
  EXPECT_THROW((void)solve_exact(heavy_cantilever(1, 0), {.tolerance = -1}), std::invalid_argument);
  Problem problem = heavy_cantilever(1, 0);
  problem.obstacles = {{obstacle::Body::sphere({0.5, -0.3, 0}, 0.1)}};
  EXPECT_THROW((void)solve_exact(problem), std::invalid_argument);
}

TEST(Samples, RefuseArcLengthsOffTheRod) {
  const Equilibrium result = solve_exact(heavy_cantilever(1, 0));
  EXPECT_THROW((void)test::sample_at(result, 1.1), std::invalid_argument);
}

}  // namespace
}  // namespace dlo::energy_model
