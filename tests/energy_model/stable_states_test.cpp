// Every stable state of planar rods is listed and the lowest is returned: a short run of
// dlo_stable_states.

#include "stable_states.hpp"

#include <gtest/gtest.h>

#include "../sanitized.hpp"

namespace dlo::energy_model {
namespace {

TEST(StableStates, AllOfPlanarRodsAreListed) {
  int states = 0;
  for (int i = 0; i < test::draws(15); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    test::StableStates search(static_cast<unsigned>(7000 + i));
    const Problem problem = search.random_problem(static_cast<test::StableStates::Held>(i % 3));
    const std::vector<Equilibrium> listed = all_energy(problem);
    const Equilibrium lowest = solve_energy(problem);
    for (const Equilibrium& state : search.find(problem, 60)) {
      ++states;
      const bool known = std::any_of(listed.begin(), listed.end(), [&](const Equilibrium& other) {
        return test::StableStates::distance(state, other) < 1e-5;
      });
      EXPECT_TRUE(known) << state.energy.total() << " J";
      EXPECT_LE(lowest.energy.total(), state.energy.total() + 1e-8);
    }
  }
  EXPECT_GE(states, test::draws(10));  // of some scenes all stable shapes leave the plane
  RecordProperty("states", states);
}

}  // namespace
}  // namespace dlo::energy_model
