#include "report/report.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "base/input_file.hpp"
#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "figure/series.hpp"
#include "paper/printed_tables.hpp"
#include "parallel/threads.hpp"
#include "scene/builtin_data.hpp"
#include "study/hard_case.hpp"

namespace dlo::compare {
namespace {

/// A file's name as every shell and every page can hold it, and that no other scene has.
std::string plain_name(const std::string& path, const std::vector<SceneFile>& others) {
  std::string stem = std::filesystem::path(path).stem().string();
  for (char& c : stem) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '.' || c == '_' || c == '-';
    if (!plain) c = '_';
  }
  if (stem.empty() || stem.front() == '-' || stem.front() == '.') stem.insert(0, "scene");
  const auto taken = [&](const std::string& name) {
    return std::any_of(others.begin(), others.end(),
                       [&](const SceneFile& other) { return other.name == name; });
  };
  std::string name = stem + ".toml";
  for (int i = 2; taken(name); ++i) name = fmt::format("{}_{}.toml", stem, i);
  return name;
}

std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") paths.push_back(entry.path().string());
  }
  if (error) throw InputError(fmt::format("{}: cannot be read ({})", folder, error.message()));
  if (paths.empty()) {
    throw InputError(fmt::format("{}: no scene in this folder (allowed: *.toml)", folder));
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

SceneFile built_in(const std::string& name, std::string_view text) {
  return {name, std::string(text), parse_scene(std::string(text), name)};
}

ForceModelSettings hooke_consistent(const ForceModelSettings& settings) {
  ForceModelSettings result = settings;
  result.law = BendingLaw::hooke;
  result.bookkeeping = Bookkeeping::consistent;
  result.c_b.reset();
  result.design_curvature.reset();
  result.point_weight.reset();
  return result;
}

/// What the tasks of a report find; failures in their order.
struct SceneTask {
  SceneReport report;
  std::optional<SceneHistory> printed_weight;
  std::vector<std::string> failures;
};

/// Runs it; what does not converge, or is no task for the model, is a failure.
template <typename Function>
void try_to(const std::string& what, std::vector<std::string>& failures, const Function& function) {
  try {
    function();
  } catch (const ResultError& error) {
    failures.push_back(fmt::format("{}: {}", what, error.what()));
  } catch (const std::invalid_argument& error) {
    failures.push_back(fmt::format("{}: {}", what, error.what()));
  }
}

SceneHistory history_of(Scene scene, const std::string& file, PaperWeight weight) {
  ForceModelSettings& settings = scene.force_model;
  if (!settings.c_c) settings.c_c = scene.axial_stiffness() / 1000;
  if (weight == PaperWeight::printed) settings.point_weight = printed_point_weight();
  const Solution rest = solve_force(scene, settings);
  SceneHistory result;
  result.scene = scene.name;
  result.file = file;
  result.point_weight = rest.parameters.point_weight;
  result.weight = weight;
  result.rest = fit_effective_modulus(scene, rest.shape);
  result.history = modulus_history(scene, rest.shape);
  return result;
}

/// Along the rod that the page shows, if solve() comes to the same one.
std::vector<double> tension_along(const Scene& scene, const Reference& rod) {
  constexpr double same = 1e-6;  // of the length
  const std::vector<double> s = drawn_arc_lengths(scene.length);
  Solution solution = solve(scene, Model::energy, {}, s);
  const double apart = (solution.shape.points - rod(s).points).colwise().norm().maxCoeff();
  if (!(apart <= same * scene.length)) return {};
  return std::move(solution.tension);
}

/// Whose scene it is.
enum class Origin { paper, user };

void run_task(SceneTask& task, const ReportOptions& options, Origin origin) {
  const Scene& scene = task.report.file.scene;
  std::vector<Comparison>& comparisons = task.report.comparisons;
  try_to(scene.name, task.failures, [&] { comparisons.push_back(compare(scene)); });
  const ForceModelSettings& own = scene.force_model;
  if (own.law != BendingLaw::hooke || own.bookkeeping != Bookkeeping::consistent) {
    Scene better = scene;
    better.force_model = hooke_consistent(own);
    try_to(scene.name + ", law hooke, bookkeeping consistent", task.failures,
           [&] { comparisons.push_back(compare(better)); });
  }
  if (!comparisons.empty()) {
    try_to(scene.name + ", tension along the rod", task.failures,
           [&] { task.report.tension = tension_along(scene, comparisons.front().reference_rod); });
  }
  if (!options.history || !straight_rod(scene, {0})) return;
  try_to(scene.name + ", E*/E against time", task.failures, [&] {
    task.report.history = history_of(scene, task.report.file.name, PaperWeight::of_the_rod);
  });
  if (origin != Origin::paper) return;
  try_to(scene.name + ", E*/E against time, printed weight", task.failures, [&] {
    task.printed_weight = history_of(scene, task.report.file.name, PaperWeight::printed);
  });
}

void add_scenes(const std::vector<SceneFile>& files, std::size_t of_the_paper, Report& report) {
  std::vector<SceneTask> tasks(files.size());
  for (std::size_t i = 0; i < files.size(); ++i) tasks[i].report.file = files[i];
  tbb::task_arena arena(arena_threads(report.options.threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
      run_task(tasks[i], report.options, i < of_the_paper ? Origin::paper : Origin::user);
    });
  });
  for (SceneTask& task : tasks) {
    report.scenes.push_back(std::move(task.report));
    if (task.printed_weight) report.printed_weight.push_back(std::move(*task.printed_weight));
    report.failures.insert(report.failures.end(), task.failures.begin(), task.failures.end());
  }
}

MotionReport follow(const SceneFile& file, const ReportOptions& options) {
  MotionReport result{.file = file};
  const Scene& scene = result.file.scene;
  result.options.rates = scene.track;
  if (options.frame_rate) result.options.rates.frames = *options.frame_rate;
  result.track = track(scene, result.options);
  try {
    require_dynamic(scene);
  } catch (const InputError&) {
    return result;  // such as one with obstacles
  }
  result.moving = dynamic_track(scene, result.track, result.options, {.material = report_damping});
  return result;
}

void add_motions(const std::vector<SceneFile>& files, Report& report) {
  std::vector<const SceneFile*> moving;
  for (const SceneFile& file : files) {
    if (motion_of(file.scene)) moving.push_back(&file);
  }
  std::vector<std::optional<MotionReport>> found(moving.size());
  std::vector<std::vector<std::string>> failures(moving.size());
  tbb::task_arena arena(arena_threads(report.options.threads));
  execute(arena, [&] {
    tbb::parallel_for(std::size_t{0}, moving.size(), [&](std::size_t i) {
      const std::string name = moving[i]->scene.name + ", motion";
      try_to(name, failures[i], [&] { found[i] = follow(*moving[i], report.options); });
      if (found[i] && found[i]->track.stopped) {
        const TrackStop& stop = *found[i]->track.stopped;
        failures[i].push_back(fmt::format("{}: stopped at {:g} s: {}", name, stop.time, stop.why));
      }
    });
  });
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (found[i]) report.motions.push_back(std::move(*found[i]));
    report.failures.insert(report.failures.end(), failures[i].begin(), failures[i].end());
  }
}

/// The scenes with the least and the largest Gamma.
std::vector<const SceneFile*> extremes(const std::vector<SceneFile>& files) {
  const auto [least, largest] = std::minmax_element(
      files.begin(), files.end(),
      [](const SceneFile& a, const SceneFile& b) { return a.scene.gamma() < b.scene.gamma(); });
  if (least == largest) return {&*least};
  return {&*least, &*largest};
}

/// Of each scene by itself, so that one that fails leaves the others theirs; what one leaves over
/// of the time, the next ones may use.
void add_benchmark(const std::vector<Scene>& scenes, const Stages& progress, Report& report) {
  const BenchmarkOptions& all = *report.options.benchmark;
  BenchmarkReport together{.options = all};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    BenchmarkOptions options = all;
    options.budget_s = std::max(all.budget_s - together.seconds, 0.01 * all.budget_s) /
                       static_cast<double>(scenes.size() - i);
    try_to("benchmark of " + scenes[i].name, report.failures, [&] {
      BenchmarkReport one = run_benchmark({scenes[i]}, options, progress);
      together.scenes.push_back(std::move(one.scenes.front()));
      together.skipped.insert(together.skipped.end(), one.skipped.begin(), one.skipped.end());
      together.seconds += one.seconds;
    });
  }
  if (!together.scenes.empty()) report.benchmark = std::move(together);
}

/// Scenes whose speed is measured; of files the extremes, whose names the report keeps.
std::vector<Scene> benchmarked(const std::vector<SceneFile>& files, Report& report) {
  if (report.paper) return benchmark_scenes();
  std::vector<Scene> scenes;
  for (const SceneFile* file : extremes(files)) {
    scenes.push_back(file->scene);
    report.benchmark_files.push_back(file->name);
  }
  return scenes;
}

}  // namespace

std::vector<SceneFile> load_scene_files(const std::vector<std::string>& paths) {
  std::vector<SceneFile> files;
  const auto add = [&](const std::string& path) {
    const std::string text = read_file(path);
    files.push_back({plain_name(path, files), text, parse_scene(text, path)});
  };
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      add(path);
      continue;
    }
    for (const std::string& found : scenes_in(path)) add(found);
  }
  return files;
}

std::vector<SceneFile> report_scene_files() {
  return {built_in("spring_steel_135.toml", builtin::spring_steel_135_toml),
          built_in("spring_steel_175.toml", builtin::spring_steel_175_toml),
          built_in("spring_steel_215.toml", builtin::spring_steel_215_toml),
          built_in("long_rod.toml", builtin::long_rod_toml),
          built_in("side_load.toml", builtin::side_load_toml)};
}

std::vector<SceneFile> report_moving_files() {
  return {built_in("corner_routing.toml", builtin::corner_routing_toml),
          built_in("buckling_wire.toml", builtin::buckling_wire_toml),
          built_in("swung_rod.toml", builtin::swung_rod_toml)};
}

ReportOptions quick_report_options() {
  ReportOptions options;
  options.quick = true;
  options.benchmark = BenchmarkOptions{.budget_s = 1, .repeats = 3};
  options.map = StabilityMapOptions{.columns = 6, .rows = 16, .steps = 2000};
  options.hard_cases.reset();
  options.frame_rate = 100;
  return options;
}

Report make_report(const std::vector<SceneFile>& files, const ReportOptions& options,
                   const Stages& progress) {
  if (!(options.tolerance > 0) || options.threads < 0) {
    throw std::invalid_argument(
        fmt::format("make_report: tolerance = {}, threads = {}, must be > 0 and >= 0",
                    options.tolerance, options.threads));
  }
  const auto say = [&](const std::string& what) {
    if (progress) progress(what);
  };
  const auto counted = [&](const std::string& what) -> Progress {
    return [&say, what](std::int64_t done, std::int64_t total) {
      say(fmt::format("{}, {} of {}", what, done, total));
    };
  };
  const Timer timer;
  for (const SceneFile& file : files) (void)discretise(file.scene, file.scene.force_model);
  Report report;
  report.options = options;
  report.paper = files.empty();
  if (options.benchmark) {
    add_benchmark(
        benchmarked(files, report),
        [&](const std::string& what) { say("speed against error: " + what); }, report);
  }
  constexpr std::size_t paper_scene_files = 3;
  say("scenes: both models, and E*/E on the way to rest");
  add_scenes(report.paper ? report_scene_files() : files, report.paper ? paper_scene_files : 0,
             report);
  if (options.motion) {
    say("what moves");
    add_motions(report.paper ? report_moving_files() : files, report);
  }
  if (options.grid) {
    say("grid of shapes");
    tbb::task_arena arena(arena_threads(options.threads));
    execute(arena,
            [&] { report.grid = make_shape_grid(*options.grid, counted("grid of shapes")); });
  }
  if (options.map) {
    say("stability map");
    StabilityMapOptions map = *options.map;
    map.threads = options.threads;
    map.progress = counted("stability map");
    if (!report.paper) report.map_file = files.front().name;
    try_to("stability map", report.failures, [&] {
      report.map = stability_map(report.paper ? hard_case_scene() : files.front().scene, map);
    });
  }
  if (options.hard_cases) {
    say("hard cases");
    StabilityOptions cases = *options.hard_cases;
    cases.threads = options.threads;
    cases.progress = counted("hard cases");
    try_to("hard cases", report.failures, [&] { report.hard_cases = stability(cases); });
  }
  report.seconds = timer.seconds();
  return report;
}

}  // namespace dlo::compare
