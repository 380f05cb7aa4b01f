#include "report/again.hpp"

#include <fmt/format.h>

#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"

namespace dlo::compare {

std::string compare_command(const SceneFile& file, const Comparison& comparison) {
  const ForceModelSettings& own = file.scene.force_model;
  const ForceModelSettings& settings = comparison.settings;
  ForceModelSettings switched = own;
  switched.law = settings.law;
  switched.bookkeeping = settings.bookkeeping;
  try {
    check(switched, file.name);
  } catch (const InputError&) {
    return {};
  }
  std::string command = "dlo compare scenes/" + file.name;
  if (settings.law != own.law) command += std::string(" --law ") + to_string(settings.law);
  if (settings.bookkeeping != own.bookkeeping) {
    command += std::string(" --bookkeeping ") + to_string(settings.bookkeeping);
  }
  return command;
}

std::string benchmark_command(const Report& report) {
  std::string command = "dlo bench";
  for (const std::string& file : report.benchmark_files) command += " scenes/" + file;
  const BenchmarkOptions options = report.options.benchmark.value_or(BenchmarkOptions{});
  return command + fmt::format(" --seconds {:g} --repeats {}", options.budget_s, options.repeats);
}

std::string track_command(const MotionReport& motion) {
  std::string command = "dlo track scenes/" + motion.file.name;
  const double rate = motion.options.rates.frames;
  if (rate != motion.file.scene.track.frames) command += fmt::format(" --frame-rate {:g}", rate);
  if (motion.moving) {
    command += fmt::format(" --dynamic --damping {:g}", motion.moving->damping.material);
  }
  return command;
}

std::string map_command(const Report& report) {
  std::string command = "dlo stability";
  if (!report.map_file.empty()) command += " scenes/" + report.map_file;
  const StabilityMapOptions options = report.options.map.value_or(StabilityMapOptions{});
  return command + fmt::format(" --map cF-cc --columns {} --rows {} --map-steps {}",
                               options.columns, options.rows, options.steps);
}

std::string history_command(const Report& report) {
  return report.paper ? "dlo paper --format csv" : report_command(report, "scenes");
}

std::string report_command(const Report& report, const std::string& scenes) {
  std::string command = "dlo report " + scenes;
  if (report.options.quick) command += " --quick";
  if (report.options.tolerance != ReportOptions{}.tolerance) {
    command += fmt::format(" --tolerance {}", report.options.tolerance);
  }
  return command + " -o ../again";  // this folder has to stay a report and nothing else
}

}  // namespace dlo::compare
