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

}  // namespace dlo::compare
