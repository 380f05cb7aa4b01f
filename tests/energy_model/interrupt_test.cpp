#include "dlo/energy_model/interrupt.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <thread>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"
#include "rolled_clamps.hpp"

namespace dlo::energy_model {
namespace {

bool always_stop() { return true; }
bool never_stop() { return false; }

int checks = 0;
int last_check = 0;
bool stop_after_last_check() { return ++checks > last_check; }

TEST(Interruption, EndsASolveAsItsTimeLimitDoesAndLeavesTheResidualUnset) {
  const Interruption interruption(always_stop);
  EXPECT_TRUE(interrupted());
  const Equilibrium ended = solve_energy(heavy_cantilever(100, 0));
  EXPECT_EQ(ended.status, SolveStatus::time_limit);
  EXPECT_LT(ended.residual, 0);
  EXPECT_EQ(solve_exact(heavy_cantilever(100, 0)).status, SolveStatus::time_limit);
}

// Twisted clamps and contacts are solved in several stages, of which any may be interrupted.
TEST(Interruption, NeverMakesASolveFail) {
  const std::vector<double> s = equal_arc_lengths(1, 11);
  const Eigen::Matrix3Xd points = solve_energy(test::over_floor(40, 0.2)).sample(s).points;
  const Interruption interruption(stop_after_last_check);
  for (const Problem& problem : {test::framed_clamps(5, 0.7, 0.8, 1), test::over_floor(40, 0.1)}) {
    for (const bool near : {false, true}) {
      last_check = -1;
      for (bool ended = true; ended; last_check += 7) {
        checks = 0;
        const Equilibrium end = near ? energy_near(problem, s, points) : solve_energy(problem);
        ended = checks > last_check;
        EXPECT_TRUE(succeeded(end.status) || end.status == SolveStatus::time_limit) << end.message;
      }
    }
  }
}

TEST(Interruption, AppliesToItsScopeAndThreadOnly) {
  EXPECT_FALSE(interrupted());
  {
    const Interruption outer(always_stop);
    {
      const Interruption inner(never_stop);
      EXPECT_FALSE(interrupted());
    }
    EXPECT_TRUE(interrupted());
    bool elsewhere = true;
    std::thread([&elsewhere] { elsewhere = interrupted(); }).join();
    EXPECT_FALSE(elsewhere);
  }
  EXPECT_FALSE(interrupted());
  EXPECT_TRUE(succeeded(solve_energy(heavy_cantilever(100, 0)).status));
}

}  // namespace
}  // namespace dlo::energy_model
