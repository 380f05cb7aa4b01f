#include <memory>

#include "command/commands.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solution.hpp"
#include "option/exit_status.hpp"
#include "option/option_values.hpp"
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
    warn_of_polygons(scene);
    warn_of_no_twist(scene, "tracking by the force model");
  }
  const compare::BenchmarkReport report = [&] {
    ProgressBar bar("bench");
    return compare::run_benchmark(scenes, benchmark,
                                  [&](const std::string& what) { bar.stage(what); });
  }();
  write_output(options.output, benchmark_document(report), [&] { return benchmark_csv(report); });
  options.plot.draw([&] {
    compare::PictureRow fronts;
    for (const compare::SceneBenchmark& scene : report.scenes) {
      if (compare::has_run(scene.runs)) {
        fronts.push_back({compare::front_figure(scene)});
      }
    }
    return compare::Picture{{fronts}};
  });
  if (!report.failures.empty()) end_with(ExitStatus::not_converged);
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "speed against error of all models");
  const auto options = std::make_shared<BenchOptions>();
  command->add_option("SCENE", options->scenes,
                      "scene files (TOML); none: a steel rod and one a hundred times softer");
  add_checked(*command, "--seconds", options->benchmark.budget_s, number_between(0.1, 86400),
              "time for all runs together");
  add_checked(*command, "--repeats", options->benchmark.repeats, CLI::Range(1, 1000),
              "runs that a median is taken of");
  add_checked(*command, "--speed", options->benchmark.gripper_speed, number_between(1e-9, 1e3),
              "of the moving gripper [m/s]");
  add_program_options(*command, options->programs);
  add_checked(*command, "--time-limit", options->benchmark.program_time_limit,
              number_between(1e-3, 1e9), "of each run of a program [s]");
  add_output_options(*command, options->output);
  options->plot.add_to(*command, "error against time, with the front,");
  command->footer(
      "Examples:\n"
      "  dlo bench data/scenes/spring_steel_175.toml --seconds 2 --plot front.svg\n"
      "  dlo bench data/scenes/cable.toml --seconds 2 --with mine='dlo solve "
      "data/scenes/cable.toml --model chain --points {points} --format csv -o {shape}'");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
