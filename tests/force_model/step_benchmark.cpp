// What a step costs: the kernel against steps written with Eigen, one rod and many, and how long a
// rod takes to come to rest. Ratios (`speedup`) are taken within one benchmark, the two sides
// taking turns.
//
// The arithmetic limit. A step of one point (hooke, plane, stepper `dynamic`) does, counted in the
// kernel's source with a fused multiplication and addition as one operation,
//     segment     2 differences, 2 products, 1 root
//     joint       ab, s.s', opening, bound and its comparison with the selection, b opening,
//                 1 division, 1/b, m: 12
//     force       extension, tension, h (4), h.s (2), along (2), T (4), inner (2), load (2),
//                 free (2): 20
//     proposal    dP (4), dP.last (2), its comparison and selection (2), turned (1), difference
//                 (2), square (3), maximum and sum (2), |dP|^2 is not needed: 16
//     movement    scale (2), selection (2), addition (2): 6
// that is 58 operations, one division and one root; in space 16 more. A core that does two of them
// at a time on 256 bits (AVX2) or one on 512 bits (AVX-512 on a Zen 4, whose multipliers are 256
// bits wide) needs 58/8 = 7.3 cycles a point; the divider, which works beside them, 5 cycles for
// four divisions and 9 for four roots, 3.5 cycles a point. So the limit is about 7.3 cycles a point
// and 116 cycles, 35 ns at 3.3 GHz, for N = 16. The counter `share_of_limit` compares with that
// at the clock that DLO_BENCHMARK_GHZ names (3.3 if it does not). Loads and stores, about 25 of 64
// bytes a point and eight rods, are as many again as the operations and explain most of the rest;
// for one rod of 16 points it is the latency of the chain root, division, products, largest
// movement, c_m, of about 200 cycles that no width hides.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdlib>

#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "plain_simulation.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double operations_per_point = 58;
constexpr double operations_per_cycle = 8;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double clock_hertz() {
  const char* const gigahertz = std::getenv("DLO_BENCHMARK_GHZ");
  return 1e9 * (gigahertz != nullptr ? std::strtod(gigahertz, nullptr) : 3.3);
}

/// The paper's rod with a force to bend it out of the plane, or none.
BatchRod steel_rod(int points, Stepper stepper, double side_force = 0) {
  test::SteelRod steel;
  steel.points = points;
  BatchRod one{steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {}};
  one.rod.loads(2, points - 1) = side_force;
  const HeavyBall constants = heavy_ball(mode_bounds(one.rod, one.points));
  one.options.policy = policy(stepper);
  one.options.c_F = constants.c_F;
  one.options.c_h = constants.c_h;
  one.options.l_s = steel.segment() / 4;
  return one;
}

void report(benchmark::State& state, double plain, double kernel, double rods) {
  const auto points = static_cast<double>(state.range(0));
  const double limit = points * operations_per_point / operations_per_cycle / clock_hertz();
  state.counters["plain_ns"] = 1e9 * plain;
  state.counters["kernel_ns"] = 1e9 * kernel / rods;
  state.counters["steps_per_s"] = rods / kernel;
  state.counters["speedup"] = plain / (kernel / rods);
  state.counters["share_of_limit"] = limit / (kernel / rods);
}

/// Steps both in turns, `steps` at a time, and keeps the fastest turn of each: what other programs
/// on the machine take away does not count.
template <typename StepKernel>
void compare_with_plain(benchmark::State& state, const BatchRod& one, double rods,
                        const StepKernel& step_kernel) {
  constexpr int steps = 500;
  test::PlainSimulation plain(one.rod, one.points, one.options);
  double fastest_plain = 1;
  double fastest_kernel = 1;
  for ([[maybe_unused]] const auto& turn : state) {
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < steps; ++i) (void)plain.step();
    fastest_plain = std::min(fastest_plain, seconds_since(start) / steps);
    const Clock::time_point middle = Clock::now();
    step_kernel(steps);
    fastest_kernel = std::min(fastest_kernel, seconds_since(middle) / steps);
  }
  report(state, fastest_plain, fastest_kernel, rods);
}

/// Arguments: points, instruction set, stepper, 1 for space.
void one_rod(benchmark::State& state) {
  const double side_force = state.range(3) == 0 ? 0 : 1e-3;
  BatchRod one =
      steel_rod(static_cast<int>(state.range(0)), static_cast<Stepper>(state.range(2)), side_force);
  one.options.instruction_set = static_cast<InstructionSet>(state.range(1));
  state.SetLabel(to_string(one.options.instruction_set));
  Simulation simulation(one.rod, one.points, one.options);
  compare_with_plain(state, one, 1, [&](int steps) {
    for (int i = 0; i < steps; ++i) (void)simulation.step();
  });
}

/// 64 rods, one thread. Arguments as for one_rod.
void batch_of_64(benchmark::State& state) {
  const double side_force = state.range(3) == 0 ? 0 : 1e-3;
  BatchRod one =
      steel_rod(static_cast<int>(state.range(0)), static_cast<Stepper>(state.range(2)), side_force);
  one.options.instruction_set = static_cast<InstructionSet>(state.range(1));
  state.SetLabel(to_string(one.options.instruction_set));
  Batch batch(std::vector<BatchRod>(64, one));
  compare_with_plain(state, one, 64, [&](int steps) { batch.step(steps); });
}

void variants(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"N", "set", "stepper", "space"});
  for (const InstructionSet set : available_instruction_sets()) {
    for (const int points : {16, 64}) {
      for (const Stepper stepper : {Stepper::dynamic, Stepper::automatic}) {
        for (const int space : {0, 1}) {
          benchmark->Args({points, static_cast<int>(set), static_cast<int>(stepper), space});
        }
      }
    }
  }
}
BENCHMARK(one_rod)->Apply(variants)->Unit(benchmark::kMicrosecond);
BENCHMARK(batch_of_64)->Apply(variants)->Unit(benchmark::kMicrosecond);

/// From straight until the tip stays within 1e-3 of its movement from where it rests. Argument: by
/// how much E is lowered.
void straight_to_rest(benchmark::State& state) {
  test::SteelRod steel;
  steel.EI /= static_cast<double>(state.range(0));
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, 660);
  Simulation reference(rod, steel.straight(), {});
  const RelaxResult rest = reference.relax({.tolerance = 1e-9});
  if (rest.status != RelaxStatus::at_rest) state.SkipWithError("the rod does not come to rest");
  const Eigen::Vector3d tip = reference.points().rightCols(1);
  const double near = 1e-3 * (tip - steel.straight().rightCols(1)).norm();
  long needed = 0;
  Simulation observed(rod, steel.straight(), {});
  for (long i = 1; i <= rest.steps; ++i) {
    (void)observed.step();
    if ((observed.points().rightCols(1) - tip).norm() > near) needed = i + 1;
  }
  double fastest = 1;
  for ([[maybe_unused]] const auto& run : state) {
    Simulation simulation(rod, steel.straight(), {});
    const Clock::time_point start = Clock::now();
    for (long i = 0; i < needed; ++i) (void)simulation.step();
    fastest = std::min(fastest, seconds_since(start));
  }
  state.counters["steps"] = static_cast<double>(needed);
  state.counters["ms_to_rest"] = 1e3 * fastest;
}
BENCHMARK(straight_to_rest)->ArgName("E_over")->Arg(1)->Arg(100)->Unit(benchmark::kMicrosecond);

/// Cost of a step against N: `ns_per_point` should not grow.
void many_points(benchmark::State& state) {
  const BatchRod one = steel_rod(static_cast<int>(state.range(0)), Stepper::dynamic);
  Simulation simulation(one.rod, one.points, one.options);
  for ([[maybe_unused]] const auto& step : state) (void)simulation.step();
  state.SetComplexityN(state.range(0));
  state.counters["ns_per_point"] =
      benchmark::Counter(1e-9 * static_cast<double>(state.iterations() * state.range(0)),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(many_points)->RangeMultiplier(10)->Range(10, 100000)->Complexity(benchmark::oN);

}  // namespace
}  // namespace dlo::force_model

BENCHMARK_MAIN();
