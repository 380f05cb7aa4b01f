#include "study/benchmark.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygon/energy_problems.hpp"
#include "polygon/point_layout.hpp"
#include "study/benchmark_runs.hpp"

namespace dlo::compare {
namespace {

constexpr double frame_s = 1e-3;

/// Times and errors of the frames of one run.
struct Frames {
  std::vector<double> seconds;
  long evaluations = 0;
  double sum_of_squares = 0;  // sum of the squared errors, each divided by the length
  int errors = 0;

  void add_error(double square) {
    sum_of_squares += square;
    ++errors;
  }

  void add(BenchmarkRun& run) const {
    const auto count = static_cast<double>(seconds.size());
    run.time = timing_of(seconds);
    run.evaluations = std::lround(static_cast<double>(evaluations) / count);
    run.rms_over_length = std::sqrt(sum_of_squares / errors);
  }
};

/// Returns the scene with its grippers at the end of a frame: moved along +x and rotated about z as
/// one body. Without obstacles the rotation changes the shape, the translation does not.
Scene moved(const Scene& scene, const BenchmarkOptions& options, int frame) {
  const double distance = (frame + 1) * frame_s * options.gripper_speed;
  const Eigen::AngleAxisd turn(distance / scene.length, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d origin = scene.grippers.front().position;
  Scene result = scene;
  for (Gripper& gripper : result.grippers) {
    gripper.position =
        origin + distance * Eigen::Vector3d::UnitX() + turn * (gripper.position - origin);
    if (gripper.direction) gripper.direction = (turn * *gripper.direction).normalized();
    if (gripper.frame && gripper.frame->d1) gripper.frame->d1 = turn * *gripper.frame->d1;
  }
  return result;
}

/// Quasi-static shapes at the frames at which errors are measured.
struct ReferenceTrack {
  static constexpr int stride = 10;
  std::vector<energy_model::Equilibrium> rods;

  [[nodiscard]] static bool is_sampled(int frame) { return frame % stride == 0; }
  [[nodiscard]] double square_error(const Scene& scene, const Shape& shape, int frame) const {
    const energy_model::Equilibrium& rod = rods[static_cast<std::size_t>(frame / stride)];
    return std::pow(distance(shape, rod.sample) / scene.length, 2);
  }
};

ReferenceTrack make_reference_track(const Scene& scene, Model model,
                                    const BenchmarkOptions& options) {
  ReferenceTrack track;
  for (int frame = 0; frame < options.frames; frame += ReferenceTrack::stride) {
    track.rods.push_back(solve_reference(moved(scene, options, frame), model));
  }
  return track;
}

BenchmarkRun track_energy(const Scene& scene, int terms, const ReferenceTrack& track,
                          const BenchmarkOptions& options) {
  energy_model::EnergySolver solver({.terms = terms});
  energy_model::Problem problem = energy_problem(scene);
  (void)solver.solve(problem);
  const std::vector<double> s = equal_arc_lengths(scene.length, 21);
  Frames frames;
  for (int frame = 0; frame < options.frames; ++frame) {
    problem = energy_problem(moved(scene, options, frame));
    const Timer timer;
    const energy_model::Equilibrium rod = solver.follow(problem);
    const Eigen::Matrix3Xd points = rod.sample(s).points;
    frames.seconds.push_back(timer.seconds());
    frames.evaluations += rod.evaluations;
    if (ReferenceTrack::is_sampled(frame)) {
      frames.add_error(track.square_error(scene, {s, points}, frame));
    }
  }
  BenchmarkRun run{.scene = scene.name, .model = Model::energy, .size = terms};
  frames.add(run);
  return run;
}

/// Returns the number of steps that fit into a frame, measured on a copy of the simulation. The
/// median of several trials is used, since other load on the machine may delay any one of them.
long frame_steps(force_model::Simulation simulation) {
  constexpr int timing_trials = 15;
  constexpr int steps = 200;
  std::vector<double> seconds;
  for (int trial = 0; trial < timing_trials; ++trial) {
    const Timer timer;
    for (int i = 0; i < steps; ++i) (void)simulation.step();
    seconds.push_back(timer.seconds());
  }
  const double step_s = timing_of(seconds).median_s / steps;
  return std::max(1L, std::lround(std::floor(frame_s / step_s)));
}

BenchmarkRun track_force(const Scene& scene, const ForceVariant& variant, int points,
                         const ReferenceTrack& track, const BenchmarkOptions& options) {
  const ForceModelSettings settings = variant.settings(scene, points);
  Discretisation discretisation = discretise(scene, settings);
  std::vector<std::size_t> all(scene.obstacles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  // All obstacles are included, because the gripper will move.
  set_obstacles(scene, all, discretisation);
  force_model::Simulation simulation(discretisation.rod, discretisation.starts.front(),
                                     step_options(settings, discretisation));
  (void)simulation.relax({.tolerance = 1e-5});
  const long steps = variant.stepper == Stepper::implicit ? 1 : frame_steps(simulation);
  Frames frames;
  for (int frame = 0; frame < options.frames; ++frame) {
    const Discretisation now = discretise(moved(scene, options, frame), settings);
    const Timer timer;
    for (std::size_t i = 0; i < now.rod.grips.size(); ++i) {
      simulation.move_grip(i, now.rod.grips[i].targets, now.rod.grips[i].reference);
    }
    for (long i = 0; i < steps; ++i) (void)simulation.step();
    frames.seconds.push_back(timer.seconds());
    frames.evaluations += steps;
    if (ReferenceTrack::is_sampled(frame)) {
      frames.add_error(track.square_error(scene, now.shape(simulation.points()), frame));
    }
  }
  BenchmarkRun run{.scene = scene.name, .model = Model::force, .size = points, .variant = variant};
  frames.add(run);
  return run;
}

std::vector<BenchmarkRun> tracking_runs(const Scene& scene, const ReferenceShape& reference,
                                        const BenchmarkOptions& options, Stopwatch& watch) {
  std::vector<BenchmarkRun> runs;
  ReferenceTrack track;
  const double predicted_track =
      reference.rod.seconds * options.frames / static_cast<double>(ReferenceTrack::stride);
  const auto find = [&] { track = make_reference_track(scene, reference.model, options); };
  if (!watch.run_once(scene.name + ": tracking, reference", predicted_track, find)) return runs;
  const auto add = [&](const std::string& name, double predicted, std::vector<BenchmarkRun>& to,
                       const std::function<BenchmarkRun()>& work) {
    BenchmarkRun run;
    if (watch.run_once(fmt::format("{}: tracking, {}", scene.name, name), predicted,
                       [&] { run = work(); })) {
      to.push_back(std::move(run));
    }
  };
  const auto add_energy = [&](int terms) {
    // Each run is about as fast as the previous one; the first is short.
    const double predicted = runs.empty() ? 0 : runs.back().time.median_s * options.frames;
    add(name_of({.model = Model::energy, .size = terms}), predicted, runs,
        [&] { return track_energy(scene, terms, track, options); });
  };
  const std::array<ForceVariant, 3> variants = {ForceVariant{.stretch_share = 1e-3}, ForceVariant{},
                                                ForceVariant{.stepper = Stepper::implicit}};
  std::array<std::vector<BenchmarkRun>, variants.size()> force_runs;
  const auto add_force = [&](int points) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      add(name_of({.model = Model::force, .size = points, .variant = variants[i]}),
          options.frames * frame_s, force_runs[i],
          [&] { return track_force(scene, variants[i], points, track, options); });
    }
  };
  // The cheapest run of both models comes first.
  add_energy(3);
  add_force(8);
  for (const int terms : {6, 12, 0}) add_energy(terms);
  for (const int points : {16, 32}) add_force(points);
  for (const std::vector<BenchmarkRun>& of_variant : force_runs) {
    runs.insert(runs.end(), of_variant.begin(), of_variant.end());
  }
  return runs;
}

bool is_run_of(const BenchmarkRun& run, std::optional<Model> model) {
  return !model || (run.program.empty() && run.model == *model);
}

/// Returns two scenes: the paper's steel rod (Gamma = 0.18, horizontal), and one with a hundredth
/// of its Young's modulus.
std::vector<Scene> benchmark_scenes() {
  Scene steel;
  steel.name = "spring steel, horizontal";
  steel.file = "built-in";
  steel.length = 0.5;
  steel.diameter = 0.002;
  steel.material = {.name = "spring_steel",
                    .youngs_modulus = 210e9,
                    .density = 7900,
                    .source = "Table 5 of the paper"};
  steel.grippers = {{.direction = Eigen::Vector3d::UnitX()}};
  Scene soft = steel;
  soft.name = "a hundred times softer";
  soft.material.youngs_modulus /= 100;
  return {steel, soft};
}

}  // namespace

ForceModelSettings ForceVariant::settings(const Scene& scene, int points) const {
  ForceModelSettings result;
  result.points = points;
  result.law = law;
  result.bookkeeping = bookkeeping;
  result.stepper = stepper;
  result.c_c = stretch_share * scene.axial_stiffness();
  return result;
}

std::string model_of(const BenchmarkRun& run) {
  return run.program.empty() ? to_string(run.model) : run.program;
}

std::string setting_of(const BenchmarkRun& run) {
  if (!run.program.empty()) return "";
  if (!run.variant) return run.model == Model::energy && run.size == 0 ? "K as needed" : "";
  const ForceVariant& variant = *run.variant;
  std::string result =
      fmt::format("{}, {}", to_string(variant.law), to_string(variant.bookkeeping));
  // A chain has no steps, and is inextensible or nearly so.
  if (run.model == Model::chain) return result;
  const double share = variant.stretch_share;
  return fmt::format("{}, {}, c_c = {}", result, to_string(variant.stepper),
                     share == 1 ? "AE" : fmt::format("AE/{:g}", 1 / share));
}

std::string name_of(const BenchmarkRun& run) {
  std::string name = model_of(run);
  const bool is_dlo = run.program.empty();
  if (is_dlo && run.model == Model::energy && run.size > 0)
    name += fmt::format(" K = {}", run.size);
  if (!is_dlo || run.variant) name += fmt::format(" N = {}", run.size);
  const std::string setting = setting_of(run);
  return setting.empty() ? name : name + ", " + setting;
}

void mark_pareto_front(std::vector<BenchmarkRun>& runs) {
  for (BenchmarkRun& run : runs) {
    run.front = std::none_of(runs.begin(), runs.end(), [&](const BenchmarkRun& other) {
      const bool no_worse =
          other.time.median_s <= run.time.median_s && other.rms_over_length <= run.rms_over_length;
      const bool better =
          other.time.median_s < run.time.median_s || other.rms_over_length < run.rms_over_length;
      return no_worse && better;
    });
  }
}

std::optional<std::size_t> fastest_within(const std::vector<BenchmarkRun>& runs, double error,
                                          std::optional<Model> model) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!(runs[i].rms_over_length <= error) || !is_run_of(runs[i], model)) continue;
    if (!best || runs[i].time.median_s < runs[*best].time.median_s) best = i;
  }
  return best;
}

bool has_run(const std::vector<BenchmarkRun>& runs, std::optional<Model> model) {
  return std::any_of(runs.begin(), runs.end(),
                     [&](const BenchmarkRun& run) { return is_run_of(run, model); });
}

BenchmarkReport run_benchmark(const std::vector<Scene>& scenes, const BenchmarkOptions& options,
                              const Stages& progress) {
  if (!(options.budget_s > 0) || options.repeats < 1 || !(options.gripper_speed > 0) ||
      options.frames < 1 || !(options.program_time_limit > 0)) {
    throw std::invalid_argument(fmt::format(
        "run_benchmark: budget_s = {} (allowed: > 0), repeats = {} (>= 1), gripper_speed = "
        "{} (> 0), frames = {} (>= 1), program_time_limit = {} (> 0)",
        options.budget_s, options.repeats, options.gripper_speed, options.frames,
        options.program_time_limit));
  }
  if (scenes.empty()) return run_benchmark(benchmark_scenes(), options, progress);
  BenchmarkReport report;
  report.options = options;
  Stopwatch watch(options, report.skipped);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (progress) progress(scenes[i].name);
    // Each scene may use an equal part of the remaining budget, so that time saved on one scene is
    // available to the next ones.
    watch.allow((options.budget_s - watch.seconds()) / static_cast<double>(scenes.size() - i));
    SceneBenchmark scene;
    scene.scene = scenes[i].name;
    scene.gamma = scenes[i].gamma();
    ReferenceShape reference = benchmark_reference(scenes[i]);
    scene.reference = reference.model;
    StaticRuns static_runs(scenes[i], reference, options, watch);
    // The cheapest run of every model comes first, so that it does not depend on the time of the
    // tracking runs.
    (void)static_runs.next_round();
    // The median time predicts later solutions better than the time of the first solution.
    for (const BenchmarkRun& run : static_runs.runs()) {
      if (is_run_of(run, Model::exact)) reference.rod.seconds = run.time.median_s;
    }
    scene.tracking = tracking_runs(scenes[i], reference, options, watch);
    while (static_runs.next_round()) continue;
    scene.runs = static_runs.runs();
    const std::vector<BenchmarkFailure>& failures = static_runs.failures();
    report.failures.insert(report.failures.end(), failures.begin(), failures.end());
    report.notes.insert(report.notes.end(), static_runs.notes().begin(), static_runs.notes().end());
    mark_pareto_front(scene.runs);
    mark_pareto_front(scene.tracking);
    for (const double error : {0.1, 0.01, 1e-3, 1e-6}) {
      scene.answers.push_back({error, fastest_within(scene.runs, error)});
      scene.tracking_answers.push_back({error, fastest_within(scene.tracking, error)});
    }
    scene.energy_at_1e6 = fastest_within(scene.runs, 1e-6, Model::energy);
    scene.force_at_1e3 = fastest_within(scene.runs, 1e-3, Model::force);
    report.scenes.push_back(std::move(scene));
  }
  report.seconds = watch.seconds();
  return report;
}

}  // namespace dlo::compare
