#include "study/benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dlo/compare/solution.hpp"
#include "study/benchmark_runs.hpp"

namespace dlo::compare {

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
  const bool ours = run.program.empty();
  if (ours && run.model == Model::energy && run.size > 0) name += fmt::format(" K = {}", run.size);
  if (!ours || run.variant) name += fmt::format(" N = {}", run.size);
  const std::string setting = setting_of(run);
  return setting.empty() ? name : name + ", " + setting;
}

namespace {

bool is_run_of(const BenchmarkRun& run, std::optional<Model> model) {
  return !model || (run.program.empty() && run.model == *model);
}

}  // namespace

void mark_front(std::vector<BenchmarkRun>& runs) {
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
    throw std::invalid_argument(
        fmt::format("run_benchmark: budget_s = {}, repeats = {}, gripper_speed = {}, frames = {}, "
                    "program_time_limit = {}, must be > 0, >= 1, > 0, >= 1 and > 0",
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
    mark_front(scene.runs);
    mark_front(scene.tracking);
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
