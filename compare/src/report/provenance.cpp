#include "report/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <gsl/gsl_version.h>
#include <nlopt.h>
#include <sys/utsname.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>

#include <Eigen/Core>
#include <chrono>
#include <fstream>

#include "dlo/compare/error.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/force_model/instruction_set.hpp"

namespace dlo::compare {
namespace {

std::string compiler() {
#if defined(__clang__)
  const std::string name = "Clang " __clang_version__;
#elif defined(__GNUC__)
  const std::string name = "GCC " __VERSION__;
#else
  const std::string name = "unknown";
#endif
#if defined(__OPTIMIZE__)
  return name + ", optimised";
#else
  return name + ", not optimised: times mean nothing";
#endif
}

std::string processor() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

std::string libraries() {
  int major = 0;
  int minor = 0;
  int patch = 0;
  nlopt_version(&major, &minor, &patch);
  return fmt::format("Eigen {}.{}.{}, NLopt {}.{}.{}, GSL {}, oneTBB {}", EIGEN_WORLD_VERSION,
                     EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, major, minor, patch, gsl_version,
                     TBB_runtime_version());
}

std::string machine() {
  utsname system = {};
  if (::uname(&system) != 0) return processor();
  return fmt::format("{}, {} threads, {} {} {}", processor(),
                     tbb::this_task_arena::max_concurrency(), system.sysname, system.release,
                     system.machine);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return {
      {"compiler", compiler()},
      {"libraries", libraries()},
      {"machine", machine()},
      {"steps of the force model", force_model::to_string(force_model::fastest_instruction_set())},
      {"written", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(now))}};
}

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
