#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "option/command_line.hpp"
#include "option/output.hpp"
#include "option/plot.hpp"
#include "option/scene_options.hpp"
#include "option/terminal.hpp"
#include "picture/figures.hpp"
#include "series/study_output.hpp"
#include "study/benchmark.hpp"

namespace dlo::cli {
namespace {

struct BenchOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> programs;
  compare::BenchmarkOptions benchmark;
  OutputOptions output;
  PlotOptions plot;
};

void run(const BenchOptions& options) {
  options.plot.require_drawable();
  compare::BenchmarkOptions benchmark = options.benchmark;
  benchmark.programs = compare::parse_foreign_programs(options.programs);
  std::vector<compare::Scene> scenes;
  for (const std::string& path : options.scenes) scenes.push_back(compare::load_scene(path));
  for (const compare::Scene& scene : scenes) {
    warn_of_neglected_by_polygon(scene);
    warn_of_no_twist(scene, "tracking by the force model");
  }
  const compare::BenchmarkReport report = [&] {
    ProgressBar bar("bench");
    return compare::run_benchmark(scenes, benchmark,
                                  [&](const std::string& what) { bar.stage(what); });
  }();
  for (const std::string& note : report.notes) print_message("{}", note);
  write_output(options.output, benchmark_document(report),
               {{"csv", [&] { return benchmark_csv(report); }}});
  options.plot.draw([&] {
    compare::PictureRow fronts;
    for (const compare::SceneBenchmark& scene : report.scenes) {
      if (compare::has_run(scene.runs)) {
        fronts.push_back({compare::front_figure(scene)});
      }
    }
    return compare::Picture{{fronts}};
  });
  if (!report.failures.empty()) exit_with_status(ExitStatus::not_converged);
}

}  // namespace

void add_bench_command(CLI::App& app) {
  add_command<BenchOptions>(app, "bench", run, [](Command& command, BenchOptions& o) {
    command.bind("SCENE", o.scenes, "--seconds", o.benchmark.budget_s, "--repeats",
                 o.benchmark.repeats, "--speed", o.benchmark.gripper_speed, "--with", o.programs,
                 "--time-limit", o.benchmark.program_time_limit, o.output, o.plot);
  });
}

}  // namespace dlo::cli
