// Time of a step: the kernel against steps written with Eigen, one rod and many, and the time until
// a rod comes to rest. Ratios (`speedup`) are measured within one benchmark, in alternating runs.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <vector>

#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"
#include "plain_simulation.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

/// Processor time: what other programs on the machine take away does not count.
double seconds_since(std::clock_t start) {
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
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
  state.counters["plain_ns"] = 1e9 * plain;
  state.counters["kernel_ns"] = 1e9 * kernel / rods;
  state.counters["steps_per_s"] = rods / kernel;
  state.counters["speedup"] = plain / (kernel / rods);
}

/// Runs the plain simulation and the kernel alternately, `steps` steps at a time, and reports the
/// shortest time of each.
template <typename StepKernel>
void compare_with_plain(benchmark::State& state, const BatchRod& one, double rods,
                        const StepKernel& step_kernel) {
  constexpr int steps = 1000;
  test::PlainSimulation plain(one.rod, one.points, one.options);
  double fastest_plain = 1;
  double fastest_kernel = 1;
  for ([[maybe_unused]] const auto& turn : state) {
    const std::clock_t start = std::clock();
    for (int i = 0; i < steps; ++i) (void)plain.step();
    fastest_plain = std::min(fastest_plain, seconds_since(start) / steps);
    const std::clock_t middle = std::clock();
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

/// Measures the time from a straight start until the tip stays within 1e-3 of its displacement from
/// its position at rest. Argument: divisor of E.
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
    const std::clock_t start = std::clock();
    for (long i = 0; i < needed; ++i) (void)simulation.step();
    fastest = std::min(fastest, seconds_since(start));
  }
  state.counters["steps"] = static_cast<double>(needed);
  state.counters["ms_to_rest"] = 1e3 * fastest;
}
BENCHMARK(straight_to_rest)->ArgName("E_over")->Arg(1)->Arg(100)->Unit(benchmark::kMicrosecond);

/// `implicit`, a soft rod (Gamma = 18, c_c = A E): from straight until all points are within
/// `error` (RMS over the length) of rest, the same with the proof of rest (relax), and a frame of 1
/// ms behind a gripper that moves and turns as that of dlo bench. `plain` is a step of `auto` of
/// the same rod in the same run. Argument: points.
void implicit_steps(benchmark::State& state) {
  test::SteelRod steel;
  steel.points = static_cast<int>(state.range(0));
  steel.EI /= 100;
  const Rod rod = steel.rod({BendingLaw::hooke, steel.EI}, steel.AE / 100);
  const StepOptions options{.policy = policy(Stepper::implicit)};
  const auto error = [&](const Simulation& a, const Simulation& b) {
    return (a.points() - b.points()).norm() / std::sqrt(steel.points) / steel.length;
  };
  Simulation rest(rod, steel.straight(), options);
  if (rest.relax({.tolerance = 1e-10}).status != RelaxStatus::at_rest) {
    state.SkipWithError("the rod does not come to rest");
  }
  const auto steps_to = [&](double share) {
    Simulation simulation(rod, steel.straight(), options);
    int steps = 0;
    while (!(error(simulation, rest) <= share)) {
      if (simulation.step().status != StepStatus::good) break;
      ++steps;
    }
    return steps;
  };
  const int coarse = steps_to(1e-3);
  const int fine = steps_to(1e-7);
  using Clock = std::chrono::steady_clock;
  const auto fastest = [](double& best, const auto& work) {
    const Clock::time_point begin = Clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - begin).count());
  };
  const auto make = [&](Simulation& simulation, int steps) {
    for (int i = 0; i < steps; ++i) (void)simulation.step();
  };
  double to_coarse = 1;
  double to_fine = 1;
  double proved = 1;
  double plain = 1;
  double squares = 0;
  int frames = 0;
  std::vector<double> frame_times;
  Simulation automatic(rod, steel.straight(), {});
  Simulation follower = rest;
  for ([[maybe_unused]] const auto& turn : state) {
    Simulation first(rod, steel.straight(), options);
    fastest(to_coarse, [&] { make(first, coarse); });
    Simulation second(rod, steel.straight(), options);
    fastest(to_fine, [&] { make(second, fine); });
    Simulation third(rod, steel.straight(), options);
    fastest(proved, [&] { (void)third.relax(); });
    fastest(plain, [&] { make(automatic, 1000); });
    const double way = 1e-4 * ++frames;
    const double angle = way / steel.length;
    const Eigen::Matrix3Xd targets = grip_targets(
        {way, 0, 0}, {std::cos(angle), std::sin(angle), 0}, steel.segment(), steel.segment() / 2);
    double frame = 1;
    fastest(frame, [&] {
      follower.move_grip(0, targets, {way, 0, 0});
      make(follower, 1);
    });
    frame_times.push_back(frame);
    Simulation there = follower;
    (void)there.relax({.tolerance = 1e-10});
    squares += std::pow(error(follower, there), 2);
  }
  plain /= 1000;
  const auto middle = frame_times.begin() + static_cast<long>(frame_times.size() / 2);
  std::nth_element(frame_times.begin(), middle, frame_times.end());
  state.counters["plain_us"] = 1e6 * plain;
  state.counters["to_1e-3_us"] = 1e6 * to_coarse;
  state.counters["to_1e-7_us"] = 1e6 * to_fine;
  state.counters["proved_us"] = 1e6 * proved;
  state.counters["frame_us"] = 1e6 * *middle;
  state.counters["frame_error"] = std::sqrt(squares / frames);
  state.counters["to_1e-3_plain"] = to_coarse / plain;
  state.counters["to_1e-7_plain"] = to_fine / plain;
  state.counters["frame_plain"] = *middle / plain;
}
BENCHMARK(implicit_steps)->ArgName("N")->Arg(16)->Arg(32)->Arg(64)->Arg(1000)->Iterations(100);

/// Cost of a step against N: `ns_per_point` should not grow.
void many_points(benchmark::State& state) {
  const BatchRod one = steel_rod(static_cast<int>(state.range(0)), Stepper::dynamic);
  Simulation simulation(one.rod, one.points, one.options);
  const std::clock_t start = std::clock();
  for ([[maybe_unused]] const auto& step : state) (void)simulation.step();
  const auto points = static_cast<double>(state.iterations() * state.range(0));
  state.counters["ns_per_point"] = 1e9 * seconds_since(start) / points;
  state.SetComplexityN(state.range(0));
}
BENCHMARK(many_points)->RangeMultiplier(10)->Range(10, 100000)->Complexity(benchmark::oN);

}  // namespace
}  // namespace dlo::force_model

BENCHMARK_MAIN();
