#include "dlo/energy_model/interrupt.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "problems.hpp"

namespace dlo::energy_model {
namespace {

bool always_stop() { return true; }
bool never_stop() { return false; }

TEST(Interruption, EndsASolveAsItsTimeLimitDoes) {
  const Interruption interruption(always_stop);
  EXPECT_TRUE(interrupted());
  EXPECT_EQ(solve_energy(heavy_cantilever(100, 0)).status, SolveStatus::time_limit);
  EXPECT_EQ(solve_exact(heavy_cantilever(100, 0)).status, SolveStatus::time_limit);
}

TEST(Interruption, LeavesTheResidualUnset) {
  const Interruption interruption(always_stop);
  EXPECT_LT(solve_energy(heavy_cantilever(100, 0)).residual, 0);
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
