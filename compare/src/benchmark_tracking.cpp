#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmark_runs.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/force_model/simulation.hpp"

namespace dlo::compare {
namespace {

constexpr double frame_s = 1e-3;

/// The frames of one run.
struct Frames {
  std::vector<double> seconds;
  long work = 0;
  double squares = 0;  // of the errors over the length

  void add(BenchmarkRun& run) const {
    const auto count = static_cast<double>(seconds.size());
    run.time = timing_of(seconds);
    run.work = std::lround(static_cast<double>(work) / count);
    run.rms_over_length = std::sqrt(squares / count);
  }
};

Eigen::Vector3d shift_at(const BenchmarkOptions& options, int frame) {
  return (frame + 1) * frame_s * options.gripper_speed * Eigen::Vector3d::UnitX();
}

/// The rod's shape moves with the grips: the quasi-static shape.
double frame_error(const Scene& scene, const Shape& shape, const ReferenceShape& reference,
                   const Eigen::Vector3d& shift) {
  const Eigen::Matrix3Xd still = reference.rod.sample(shape.arc_length).points;
  return rms(shape.arc_length, (shape.points - still).colwise() - shift) / scene.length;
}

BenchmarkRun track_energy(const Scene& scene, int terms, const ReferenceShape& reference,
                          const BenchmarkOptions& options) {
  energy_model::EnergySolver solver({.terms = terms});
  energy_model::Problem problem = energy_problem(scene);
  (void)solver.solve(problem);
  const std::vector<double> s = equal_arc_lengths(scene.length, 21);
  Frames frames;
  for (int frame = 0; frame < options.frames; ++frame) {
    const Eigen::Vector3d shift = shift_at(options, frame);
    for (std::size_t i = 0; i < problem.grips.size(); ++i) {
      problem.grips[i].position = scene.grippers[i].position + shift;
    }
    const auto begin = std::chrono::steady_clock::now();
    const energy_model::Equilibrium rod = solver.follow(problem);
    const Eigen::Matrix3Xd points = rod.sample(s).points;
    frames.seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    frames.work += rod.evaluations;
    frames.squares += std::pow(frame_error(scene, {s, points}, reference, shift), 2);
  }
  BenchmarkRun run{.scene = scene.name, .model = Model::energy, .size = terms};
  if (terms == 0) run.setting = "K as needed";
  frames.add(run);
  return run;
}

void move_grips(force_model::Simulation& simulation, const std::vector<force_model::Grip>& grips,
                const Eigen::Vector3d& shift) {
  for (std::size_t i = 0; i < grips.size(); ++i) {
    simulation.move_grip(i, grips[i].targets.colwise() + shift, grips[i].reference + shift);
  }
}

/// Steps that fit into a frame, from a copy that is thrown away.
long steps_per_frame(force_model::Simulation simulation) {
  constexpr int trial = 1000;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < trial; ++i) (void)simulation.step();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  return std::max(1L, std::lround(std::floor(frame_s / (taken.count() / trial))));
}

BenchmarkRun track_force(const Scene& scene, const ForceVariant& variant, int points,
                         const ReferenceShape& reference, const BenchmarkOptions& options) {
  const ForceModelSettings settings = variant.settings(scene, points);
  const Discretisation discretisation = discretise(scene, settings);
  force_model::Simulation simulation(discretisation.rod, discretisation.starts.front(),
                                     step_options(settings, discretisation));
  (void)simulation.relax({.tolerance = 1e-5});
  const long steps = steps_per_frame(simulation);
  Frames frames;
  for (int frame = 0; frame < options.frames; ++frame) {
    const Eigen::Vector3d shift = shift_at(options, frame);
    const auto begin = std::chrono::steady_clock::now();
    move_grips(simulation, discretisation.rod.grips, shift);
    for (long i = 0; i < steps; ++i) (void)simulation.step();
    frames.seconds.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    frames.work += steps;
    // Inside end grippers the shape has the grippers' first position.
    Shape shape = discretisation.shape(simulation.points().colwise() - shift);
    shape.points.colwise() += shift;
    frames.squares += std::pow(frame_error(scene, shape, reference, shift), 2);
  }
  BenchmarkRun run{
      .scene = scene.name, .model = Model::force, .size = points, .setting = variant.text()};
  frames.add(run);
  return run;
}

}  // namespace

std::vector<BenchmarkRun> tracking_runs(const Scene& scene, const ReferenceShape& reference,
                                        const BenchmarkOptions& options, Stopwatch& watch) {
  std::vector<BenchmarkRun> runs;
  if (!scene.obstacles.empty()) return runs;  // the shape would not move with the grips
  const auto add = [&](const std::string& name, const std::function<BenchmarkRun()>& track) {
    BenchmarkRun run;
    const double predicted = options.frames * frame_s;
    if (watch.run_once(fmt::format("{}: tracking, {}", scene.name, name), predicted,
                       [&] { run = track(); })) {
      runs.push_back(std::move(run));
    }
  };
  for (const int terms : {3, 6, 12, 0}) {
    add(fmt::format("energy, K = {}", terms),
        [&] { return track_energy(scene, terms, reference, options); });
  }
  for (const double share : {1e-3, 1.0}) {
    for (const int points : {8, 16, 32}) {
      ForceVariant variant;
      variant.stretch_share = share;
      add(fmt::format("force, N = {}, {}", points, variant.text()),
          [&] { return track_force(scene, variant, points, reference, options); });
    }
  }
  return runs;
}

}  // namespace dlo::compare
