// Holds the speeds that the project promises, as ratios of times measured side by side: a promise
// that is not kept ends in exit status 1.
//
//     dlo_performance
//
// Both sides of a ratio take turns, some milliseconds each, by the clock of this thread's computing
// time; the ratio of a turn is that of two neighbours, and the median over the turns is taken.
// Other programs slow both sides, but not alike: a median of at least `margin` times the promised
// ratio suffices (the exponent may be 5 % out of its range), and up to `attempts` medians are
// measured. A loss that no noise explains fails all of them. Both sides are loops of little code:
// what another program on the same core does to them is alike. It slows a solve, whose code is
// much, up to three times as much as a step, so that no ratio of the two is promised; the tests
// hold how many evaluations a solve takes.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "../force_model/plain_simulation.hpp"
#include "../force_model/rods.hpp"
#include "dlo/force_model/batch.hpp"
#include "dlo/force_model/simulation.hpp"

namespace {

using namespace dlo::force_model;
using dlo::test::PlainSimulation;
using dlo::test::SteelRod;

constexpr double margin = 0.8;
constexpr int attempts = 5;
constexpr int turns = 25;
constexpr double turn_seconds = 2e-3;

double computing_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A function that is timed, and its number of repetitions in one turn.
struct Work {
  std::function<void()> run;
  long repeats = 1;

  explicit Work(std::function<void()> work) : run(std::move(work)) {
    double taken = 0;
    while (taken < turn_seconds / 2) {
      repeats *= 2;
      taken = static_cast<double>(repeats) * seconds();
    }
  }

  /// Returns the time of one repetition [s].
  [[nodiscard]] double seconds() const {
    const double begin = computing_time();
    for (long i = 0; i < repeats; ++i) run();
    return (computing_time() - begin) / static_cast<double>(repeats);
  }
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the time of one repetition of `slow` divided by that of `fast`, the median over the
/// turns.
double ratio(const Work& slow, const Work& fast) {
  std::vector<double> ratios;
  ratios.reserve(turns);
  for (int turn = 0; turn < turns; ++turn) ratios.push_back(slow.seconds() / fast.seconds());
  return median(ratios);
}

/// Returns a straight rod with the paper's length, EI and weight, with the law hooke, c_c = 660 N
/// and the stepper `automatic`.
BatchRod steel_rod(int points) {
  SteelRod steel;
  steel.points = points;
  return {steel.rod({BendingLaw::hooke, steel.EI}, 660), steel.straight(), {}};
}

Work plain_step(int points) {
  const BatchRod one = steel_rod(points);
  return Work([plain = PlainSimulation(one.rod, one.points, one.options)]() mutable {
    (void)plain.step();
  });
}

Work step(int points) {
  const BatchRod one = steel_rod(points);
  return Work([simulation = Simulation(one.rod, one.points, one.options)]() mutable {
    (void)simulation.step();
  });
}

/// Returns the work of stepping each of 64 rods once.
Work batch_step(int points) {
  auto batch = std::make_shared<Batch>(std::vector<BatchRod>(64, steel_rod(points)));
  return Work([batch] { batch->step(1); });
}

/// Returns the exponent of the cost of a step against N, by least squares over logarithms.
double slope_against_points() {
  const std::vector<int> sizes = {64, 128, 256, 512, 1024, 2048};
  std::vector<Work> works;
  works.reserve(sizes.size());
  for (const int points : sizes) works.push_back(step(points));
  std::vector<std::vector<double>> seconds(sizes.size());
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t i = 0; i < works.size(); ++i) seconds[i].push_back(works[i].seconds());
  }
  double n = 0;
  double x = 0;
  double y = 0;
  double xx = 0;
  double xy = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double log_points = std::log(sizes[i]);
    const double log_seconds = std::log(median(seconds[i]));
    n += 1;
    x += log_points;
    y += log_seconds;
    xx += log_points * log_points;
    xy += log_points * log_seconds;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

struct PerformanceRequirement {
  const char* what = "";
  double least = 0;        ///< promised lower limit; 0: none
  double most = INFINITY;  ///< promised upper limit
  double allowance = 0;    ///< share by which noise may exceed the limit
  std::function<double()> measure;
};

/// Returns the promised speeds for an instruction set. Plain Eigen code uses two numbers of a
/// register of any width, so ratios to it grow with the width. The promises for wide registers hold
/// for AVX2 and AVX-512.
std::vector<PerformanceRequirement> requirements(InstructionSet set) {
  const bool wide = set != InstructionSet::baseline;
  const Work plain_16 = plain_step(16);
  const auto times_faster = [](const Work& plain, const Work& work, double rods) {
    return [=] { return rods * ratio(plain, work); };
  };
  const double share = 1 - margin;
  return {
      {"a rod's step, N = 16: times faster than plain", wide ? 4.0 : 2.5, INFINITY, share,
       times_faster(plain_16, step(16), 1)},
      {"a rod's step, N = 64: times faster than plain", wide ? 3.0 : 2.5, INFINITY, share,
       times_faster(plain_step(64), step(64), 1)},
      {"64 rods, N = 16: times faster a rod than plain", wide ? 10.0 : 3.5, INFINITY, share,
       times_faster(plain_16, batch_step(16), 64)},
      {"cost of a step goes like N to the power of", 0.9, 1.1, 0.05, slope_against_points},
  };
}

/// Prints a line for a promise. @return whether it is kept
bool check_requirement(const PerformanceRequirement& promise) {
  const double least = promise.least * (1 - promise.allowance);
  const double most = promise.most / (1 - promise.allowance);
  double measured = 0;
  int attempt = 0;
  bool in_range = false;
  while (!in_range && attempt < attempts) {
    measured = promise.measure();
    in_range = measured >= least && measured <= most;
    ++attempt;
  }
  char promised[64];
  if (std::isinf(promise.most)) {
    std::snprintf(promised, sizeof promised, ">= %.3g", promise.least);
  } else if (promise.least > 0) {
    std::snprintf(promised, sizeof promised, "%.3g to %.3g", promise.least, promise.most);
  } else {
    std::snprintf(promised, sizeof promised, "<= %.3g", promise.most);
  }
  std::printf("  %-48s %8.3g   promised %-11s  %s", promise.what, measured, promised,
              in_range ? "kept" : "BROKEN");
  if (attempt > 1) std::printf(" (attempt %d)", attempt);
  std::printf("\n");
  return in_range;
}

}  // namespace

int main() {
  try {
    const InstructionSet set = fastest_instruction_set();
    std::printf("speed on %s; a promise may be missed by %.0f %% (the exponent by 5 %%)\n",
                to_string(set), 100 * (1 - margin));
    int broken = 0;
    for (const PerformanceRequirement& promise : requirements(set))
      broken += check_requirement(promise) ? 0 : 1;
    return broken == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
}
