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

/// Times runs within what is left of the budget.
class Stopwatch {
 public:
  Stopwatch(const BenchmarkOptions& options, std::vector<std::string>& skipped)
      : options_(options), skipped_(skipped) {}

  [[nodiscard]] double seconds() const { return timer_.seconds(); }  ///< since construction
  void allow(double seconds) { until_ = this->seconds() + seconds; }
  [[nodiscard]] double left() const { return until_ - seconds(); }

  /// Runs `work` repeatedly. Nothing if it is predicted to take more than a quarter of what is
  /// left, or does not converge.
  [[nodiscard]] std::optional<Timing> time(const std::string& name, double predicted_s,
                                           const std::function<void()>& work);

  /// The same for a run that times its own parts; false if it was skipped.
  [[nodiscard]] bool run_once(const std::string& name, double predicted_s,
                              const std::function<void()>& work);

 private:
  [[nodiscard]] bool fits(const std::string& name, double predicted_s);
  [[nodiscard]] bool done(const std::string& name, const std::function<void()>& work);

  const BenchmarkOptions& options_;
  std::vector<std::string>& skipped_;
  Timer timer_;
  double until_ = 0;
};

[[nodiscard]] Timing timing_of(std::vector<double> seconds);

struct ReferenceShape {
  Model model = Model::exact;
  energy_model::Equilibrium rod;
  /// Of `exact` and `energy` from each other, RMS over the length; NaN without exact.
  double agreement = 0;
};

[[nodiscard]] ReferenceShape benchmark_reference(const Scene& scene);

/// One model of the static runs over its sizes, the cheapest first.
struct StaticSeries {
  Model model = Model::exact;
  ForceVariant variant;                     ///< of chain and force
  const ForeignProgram* program = nullptr;  ///< in place of a model
  std::vector<int> sizes;                   ///< K or N, not yet run
  std::vector<BenchmarkRun> runs;
  double last_s = 0;    ///< time of the run before
  int last_points = 0;  ///< its N
};

/// The static runs, in rounds: the first size of every model, then the second and so on, so that a
/// small budget leaves some runs of each.
class StaticRuns {
 public:
  /// All are kept by reference.
  StaticRuns(const Scene& scene, const ReferenceShape& reference, const BenchmarkOptions& options,
             Stopwatch& watch);

  /// One round; false if nothing is left to run.
  bool next_round();
  /// All so far, by model and size.
  [[nodiscard]] std::vector<BenchmarkRun> runs() const;
  /// Of programs, so far.
  [[nodiscard]] const std::vector<BenchmarkFailure>& failures() const { return failures_; }

 private:
  void run_continuous(StaticSeries& series, int terms);
  void run_polygon(StaticSeries& series, int points);
  void run_program(StaticSeries& series, int points);

  const Scene& scene_;
  const ReferenceShape& reference_;
  const BenchmarkOptions& options_;
  Stopwatch& watch_;
  std::vector<StaticSeries> series_;
  std::vector<BenchmarkFailure> failures_;
};

[[nodiscard]] std::vector<BenchmarkRun> tracking_runs(const Scene& scene,
                                                      const ReferenceShape& reference,
                                                      const BenchmarkOptions& options,
                                                      Stopwatch& watch);

}  // namespace dlo::compare
