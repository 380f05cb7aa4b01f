// Measures the stepper `implicit`: the time to rest, and the time of a frame behind a gripper that
// moves.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "dlo/force_model/simulation.hpp"
#include "rods.hpp"

namespace dlo::force_model {
namespace {

/// `implicit`, a soft rod (Gamma = 18, a hundredth of the stiffness and A E of steel): steps from
/// straight until the distance from rest (RMS of the points over the length) is 1e-3 and 1e-7, the
/// way to rest with its proof (relax), and one step behind a gripper that moves and turns as that
/// of dlo bench. `plain` is a step of `auto` of the same rod in the same run. Argument: points.
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

}  // namespace
}  // namespace dlo::force_model

BENCHMARK_MAIN();
