#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/timer.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "study/benchmark.hpp"

namespace dlo::compare {

/// Times runs within the remaining budget.
class Stopwatch {
 public:
  Stopwatch(const BenchmarkOptions& options, std::vector<std::string>& skipped)
      : options_(options), skipped_(skipped) {}

  /// Returns the elapsed time since construction.
  [[nodiscard]] double seconds() const { return timer_.seconds(); }
  void allow(double seconds) { deadline_ = this->seconds() + seconds; }
  [[nodiscard]] double left() const { return deadline_ - seconds(); }

  /// Runs `work` repeatedly, which returns its time [s], until the times are enough or one is NaN,
  /// which makes all times of the result NaN. Returns std::nullopt if one run is predicted to take
  /// more than a quarter of the remaining budget, if no time is left, or if `work` throws.
  [[nodiscard]] std::optional<Timing> time(const std::string& name, double predicted_s,
                                           const std::function<double()>& work);

  /// Runs `work` once, which times its own parts, under the conditions of time(). @return false if
  /// it was skipped or has thrown
  [[nodiscard]] bool run_once(const std::string& name, double predicted_s,
                              const std::function<void()>& work);

 private:
  [[nodiscard]] bool fits(const std::string& name, double predicted_s);
  [[nodiscard]] bool done(const std::string& name, const std::function<void()>& work);

  const BenchmarkOptions& options_;
  std::vector<std::string>& skipped_;
  Timer timer_;
  double deadline_ = 0;
};

[[nodiscard]] Timing timing_of(std::vector<double> seconds);

struct ReferenceShape {
  Model model = Model::exact;
  energy_model::Equilibrium rod;
  /// RMS distance between the shapes of `exact` and `energy`, divided by the length; NaN without
  /// exact.
  double agreement = 0;
};

[[nodiscard]] ReferenceShape benchmark_reference(const Scene& scene);

/// Static runs of one model over its sizes, in the order of their cost.
struct StaticSeries {
  Model model = Model::energy;
  ForceVariant variant;                     ///< settings of chain and force
  const ForeignProgram* program = nullptr;  ///< foreign program in place of a model
  std::vector<int> sizes;                   ///< K or N of the runs that are left
  std::vector<BenchmarkRun> runs;
  double last_s = 0;  ///< time of the previous run [s]
  int last_size = 0;  ///< K or N of the previous run
};

/// Static runs in rounds: the first size of every model, then the second and so on, so that a small
/// budget leaves some runs of each.
class StaticRuns {
 public:
  /// Keeps references to all arguments.
  StaticRuns(const Scene& scene, const ReferenceShape& reference, const BenchmarkOptions& options,
             Stopwatch& watch);

  /// Runs one round; returns false if no run is left.
  bool next_round();
  /// Returns all runs so far, ordered by model, setting and run.
  [[nodiscard]] std::vector<BenchmarkRun> runs() const;
  [[nodiscard]] const std::vector<BenchmarkFailure>& failures() const { return failures_; }
  /// Returns how the shapes of programs were interpreted, one line each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void run(StaticSeries& series, int size);

  const Scene& scene_;
  const ReferenceShape& reference_;
  const BenchmarkOptions& options_;
  Stopwatch& watch_;
  std::vector<StaticSeries> series_;
  std::vector<BenchmarkFailure> failures_;
  std::vector<std::string> notes_;
};

}  // namespace dlo::compare
