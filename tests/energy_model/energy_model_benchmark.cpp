// Time and evaluations of the energy model. `plain_steps` is the time in units of one step of the
// plain force model (Eigen, N = 16, hooke law, heavy ball) measured in the same run; `one_clamp` in
// units of a cold solve of one horizontal clamp at Gamma = 10; `error` the largest distance of
// five points from the independent exact solution over l.
//
//     dlo_energy_model_benchmark --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "dlo/force_model/rod.hpp"
#include "random_problems.hpp"

namespace {

using dlo::energy_model::EnergySolver;
using dlo::energy_model::Equilibrium;
using dlo::energy_model::Problem;
using dlo::energy_model::solve_exact;

template <typename Work>
double median_seconds(int runs, int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) work();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    seconds.push_back(taken.count() / repeats);
  }
  std::nth_element(seconds.begin(), seconds.begin() + runs / 2, seconds.end());
  return seconds[static_cast<std::size_t>(runs / 2)];
}

/// Returns the median time [s] of one step of the plain force model at N = 16: all forces,
/// momentum, movement. Measured next to what it is compared with, so that a busy machine slows
/// both.
double plain_step() {
  dlo::force_model::Rod rod;
  const Eigen::Index n = 16;
  rod.rest_lengths = Eigen::VectorXd::Constant(n - 1, 1.0 / (n - 1));
  rod.c_c = 660;
  rod.bending = {dlo::force_model::BendingLaw::hooke, 1};
  rod.loads = Eigen::Vector3d(0, -1.0 / n, 0).replicate(1, n);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, n);
  points.row(0).setLinSpaced(n, 0, 1);
  Eigen::Matrix3Xd forces(3, n);
  Eigen::Matrix3Xd movement = Eigen::Matrix3Xd::Zero(3, n);
  return median_seconds(9, 1000, [&] {
    dlo::force_model::total_forces(rod, points, forces);
    forces.leftCols(2).setZero();
    movement = 1e-5 * forces + 0.9 * movement;
    points += movement;
    benchmark::DoNotOptimize(points.data());
  });
}

Problem clamp(double gamma, double degrees = 0) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -gamma, 0};
  const double angle = degrees * std::numbers::pi / 180;
  problem.grips = {{.at = 0, .direction = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)}};
  return problem;
}

/// Returns a rod between clamps that are `apart` l from each other along x and lean out of the
/// plane to opposite sides, with the slope `out`.
Problem two_clamps(double gamma, double apart, double out) {
  Problem problem = clamp(gamma);
  problem.grips[0].direction = Eigen::Vector3d(1, 0, out);
  problem.grips.push_back({.at = 1,
                           .position = Eigen::Vector3d(apart, 0, 0),
                           .direction = Eigen::Vector3d(1, 0, -out)});
  return problem;
}

double one_clamp() {
  EnergySolver solver;
  const Problem problem = clamp(10);
  return median_seconds(9, 100, [&] { benchmark::DoNotOptimize(solver.solve(problem)); });
}

benchmark::Counter ratio_counter(double seconds) {
  return {seconds, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

/// Returns the largest distance of five points from the exact shape of a horizontal clamp, which is
/// worked out once for each Gamma.
double error(const Equilibrium& energy, double gamma) {
  static std::map<double, Eigen::Matrix3Xd> exact;
  const std::vector<double> s = {0.1, 0.25, 0.5, 0.75, 1};
  if (!exact.contains(gamma)) exact[gamma] = solve_exact(clamp(gamma)).sample(s).points;
  const Eigen::Matrix3Xd difference = energy.sample(s).points - exact[gamma];
  return std::sqrt(difference.colwise().squaredNorm().maxCoeff());
}

void report(benchmark::State& state, const Equilibrium& result) {
  if (!succeeded(result.status)) state.SkipWithError(result.message.c_str());
  state.counters["evaluations"] = result.evaluations;
  state.counters["terms"] = result.terms;
  state.counters["plain_steps"] = ratio_counter(plain_step());
}

void cold_clamp(benchmark::State& state, double gamma) {
  const Problem problem = clamp(gamma);
  EnergySolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.solve(problem));
  const Equilibrium result = solver.solve(problem);
  report(state, result);
  state.counters["error"] = error(result, gamma);
}
BENCHMARK_CAPTURE(cold_clamp, gamma_0_18, 0.18);
BENCHMARK_CAPTURE(cold_clamp, gamma_0_2, 0.2);
BENCHMARK_CAPTURE(cold_clamp, gamma_1, 1);
BENCHMARK_CAPTURE(cold_clamp, gamma_10, 10);
BENCHMARK_CAPTURE(cold_clamp, gamma_18, 18);
BENCHMARK_CAPTURE(cold_clamp, gamma_100, 100);
BENCHMARK_CAPTURE(cold_clamp, gamma_1000, 1000);

/// Measures solves that alternate between two problems.
void follow_to_and_fro(benchmark::State& state, const std::array<Problem, 2>& problems) {
  EnergySolver solver;
  (void)solver.solve(problems[0]);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(solver.follow(problems[i = 1 - i]));
  report(state, solver.follow(problems[1 - i]));
}

/// Measures solves while the gripper rotates to and fro by 1 degree.
void warm_clamp(benchmark::State& state, double gamma) {
  follow_to_and_fro(state, {clamp(gamma), clamp(gamma, 1)});
}
BENCHMARK_CAPTURE(warm_clamp, gamma_0_2, 0.2);
BENCHMARK_CAPTURE(warm_clamp, gamma_10, 10);
BENCHMARK_CAPTURE(warm_clamp, gamma_100, 100);
BENCHMARK_CAPTURE(warm_clamp, gamma_1000, 1000);

void cold(benchmark::State& state, const Problem& problem) {
  EnergySolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.solve(problem));
  report(state, solver.solve(problem));
  state.counters["one_clamp"] = ratio_counter(one_clamp());
}
BENCHMARK_CAPTURE(cold, two_clamps_planar, two_clamps(10, 0.8, 0))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(cold, two_clamps_spatial, two_clamps(10, 0.8, 0.3))
    ->Unit(benchmark::kMicrosecond);

Problem on_a_floor() {
  Problem problem = clamp(20);
  problem.obstacles = {{dlo::obstacle::Body::half_space({0, -0.3, 0}, {0, 1, 0})}};
  return problem;
}
BENCHMARK_CAPTURE(cold, clamp_above_a_floor, on_a_floor())->Unit(benchmark::kMicrosecond);

Problem sideways_load() {
  Problem problem = clamp(10);
  problem.loads = {{.at = 1, .force = {0, 0, 5}}};
  return problem;
}
BENCHMARK_CAPTURE(cold, clamp_spatial, sideways_load())->Unit(benchmark::kMicrosecond);

/// Measures solves while the clamp at the end rotates to and fro by 1 degree.
void warm_two_clamps(benchmark::State& state) {
  Problem turned = two_clamps(10, 0.8, 0.3);
  turned.grips[1].direction = Eigen::AngleAxisd(std::numbers::pi / 180, Eigen::Vector3d::UnitY()) *
                              *turned.grips[1].direction;
  follow_to_and_fro(state, {two_clamps(10, 0.8, 0.3), turned});
}
BENCHMARK(warm_two_clamps)->Name("warm/two_clamps_spatial")->Unit(benchmark::kMicrosecond);

/// Measures the solution between clamps that hold frames, rotated against each other. `twins` is
/// the time divided by that of the same problem without held frames.
void twisted(benchmark::State& state) {
  const Problem free = two_clamps(10, 0.8, 0.3);
  Problem problem = free;
  problem.torsional_stiffness = 0.8;
  for (dlo::energy_model::Grip& grip : problem.grips) grip.frame.emplace();
  problem.grips[1].frame->roll = std::numbers::pi / 180 * static_cast<double>(state.range(0));
  EnergySolver solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.solve(problem));
  report(state, solver.solve(problem));
  EnergySolver twin;
  state.counters["twins"] =
      ratio_counter(median_seconds(9, 20, [&] { benchmark::DoNotOptimize(twin.solve(free)); }));
}
BENCHMARK(twisted)->Arg(60)->Arg(180)->Unit(benchmark::kMicrosecond);

/// Solves 300 random rods between clamps once each. Reports the median and the largest time in
/// plain steps, and the number of certified results.
void random_clamped_rods(benchmark::State& state, dlo::test::RandomSpace space, bool pin) {
  constexpr std::uint64_t count = 300;
  const double step = plain_step();
  std::vector<double> steps;
  int certified = 0;
  for (auto _ : state) {
    certified = 0;
    EnergySolver solver;
    for (std::uint64_t number = 0; number < count; ++number) {
      const Problem problem = dlo::test::random_clamped_rod(number, space, pin);
      const auto begin = std::chrono::steady_clock::now();
      const Equilibrium result = solver.solve(problem);
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      steps.push_back(taken.count() / step);
      if (succeeded(result.status)) ++certified;
    }
  }
  std::sort(steps.begin(), steps.end());
  state.counters["median"] = steps[steps.size() / 2];
  state.counters["slowest"] = steps.back();
  state.counters["certified"] = certified;
}
BENCHMARK_CAPTURE(random_clamped_rods, clamps_planar, dlo::test::RandomSpace::plane, false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(random_clamped_rods, clamps_spatial, dlo::test::RandomSpace::space, false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(random_clamped_rods, clamps_and_pin_planar, dlo::test::RandomSpace::plane, true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(random_clamped_rods, clamps_and_pin_spatial, dlo::test::RandomSpace::space, true)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
