// Whether all_energy() lists every stable state of planar rods, and solve_energy() the lowest,
// against many relaxed random polygons (stable_states.hpp).
//   dlo_stable_states [SCENES [STARTS [SEED]]]
// A line for each miss. Ends with 0 if there is none; 1 if there are some; 2 for bad usage.

#include "stable_states.hpp"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

namespace {

using dlo::energy_model::Equilibrium;
using dlo::energy_model::Problem;
using dlo::test::StableStates;

int number(int argc, char** argv, int at, int otherwise) {
  return argc > at ? std::stoi(argv[at]) : otherwise;
}

int run(int scenes, int starts, int seed) {
  int states = 0;
  int missed = 0;
  int higher = 0;
  for (int i = 0; i < scenes; ++i) {
    StableStates search(static_cast<unsigned>(seed + i));
    const Problem problem = search.random_problem(static_cast<StableStates::Held>(i % 3));
    const std::vector<Equilibrium> listed = all_energy(problem);
    const Equilibrium lowest = solve_energy(problem);
    for (const Equilibrium& state : search.find(problem, starts)) {
      ++states;
      bool known = false;
      for (const Equilibrium& other : listed) {
        known = known || StableStates::distance(state, other) < 1e-5;
      }
      const double energy = state.energy.total();
      if (!known) {
        ++missed;
        std::printf("scene %d: a stable state of %.9g J (eigenvalue %.3g) is not listed\n",
                    seed + i, energy, state.smallest_eigenvalue);
      }
      if (energy < lowest.energy.total() - 1e-8 * (1 + std::abs(energy))) {
        ++higher;
        std::printf("scene %d: %.9g J is lower than %.9g J\n", seed + i, energy,
                    lowest.energy.total());
      }
    }
  }
  std::printf("%d scenes, %d stable states, %d not listed, %d lower than the solution\n", scenes,
              states, missed, higher);
  return missed + higher > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(number(argc, argv, 1, 200), number(argc, argv, 2, 200), number(argc, argv, 3, 1));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "dlo_stable_states: %s\n", error.what());
    return 2;
  }
}
