// A rod with one clamp and a rigid body in its way: the side that costs less is found.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

using test::heavy_cantilever;

std::vector<double> everywhere() {
  std::vector<double> s;
  for (int i = 0; i <= 100; ++i) s.push_back(i / 100.0);
  return s;
}

// The rod that stands nearly upright falls to either side. A block keeps it high on the side it
// leans to, so that the free shape on the other side, which the block is nowhere near, costs less.
TEST(SidesOfBodies, ALeaningRodFallsToTheSideThatIsFree) {
  for (const double gamma : {15.0, 40.0}) {
    for (const double lean : {86.0, 94.0}) {
      const double sense = lean < 90 ? 1 : -1;
      Problem problem = heavy_cantilever(gamma, lean);
      const std::vector<Equilibrium> free = all_energy(problem);
      const auto other = std::find_if(free.begin(), free.end(), [&](const Equilibrium& state) {
        return state.status == SolveStatus::converged &&
               sense * state.sample(std::vector<double>{1.0}).points(0, 0) < 0;
      });
      ASSERT_NE(other, free.end());
      const obstacle::Body block = obstacle::Body::box(
          {sense * 0.42, -0.35, 0}, Eigen::Matrix3d::Identity(), {0.7, 1.2, 0.5}, 0.01);
      ASSERT_GT(block.clearances(other->sample(everywhere()).points).minCoeff(), 0);
      problem.obstacles = {{block}};
      const Equilibrium found = solve_energy(problem);
      ASSERT_EQ(found.status, SolveStatus::converged) << found.message;
      EXPECT_NEAR(found.energy.total(), other->energy.total(), 1e-7 * gamma)
          << gamma << " " << lean;
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
