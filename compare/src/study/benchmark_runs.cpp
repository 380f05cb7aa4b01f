#include "study/benchmark_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/force.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {
namespace {

constexpr int reference_samples = 101;

double error_of(const Scene& scene, const Shape& shape, const energy_model::Equilibrium& rod) {
  return distance(shape, rod.sample) / scene.length;
}

double error_of(const Scene& scene, const energy_model::Equilibrium& a,
                const energy_model::Equilibrium& b) {
  const std::vector<double> s = equal_arc_lengths(scene.length, reference_samples);
  return error_of(scene, {s, a.sample(s).points}, b);
}

}  // namespace

bool Stopwatch::fits(const std::string& name, double predicted_s) {
  constexpr double largest_share = 0.25;
  const double now_left = left();
  if (now_left > 0 && predicted_s <= largest_share * now_left) return true;
  skipped_.push_back(
      now_left > 0
          ? fmt::format("{}: it takes about {:.2g} s, and one run gets a quarter of the {:.2g} s "
                        "that are left (--seconds)",
                        name, predicted_s, now_left)
          : fmt::format("{}: no time is left (--seconds)", name));
  return false;
}

bool Stopwatch::done(const std::string& name, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    skipped_.push_back(fmt::format("{}: {}", name, error.what()));
    return false;
  }
  return true;
}

bool Stopwatch::run_once(const std::string& name, double predicted_s,
                         const std::function<void()>& work) {
  return fits(name, predicted_s) && done(name, work);
}

std::optional<Timing> Stopwatch::time(const std::string& name, double predicted_s,
                                      const std::function<void()>& work) {
  // Runs that are faster than this in total are repeated more often [s].
  constexpr double quick = 0.02;
  if (!fits(name, predicted_s)) return std::nullopt;
  std::vector<double> times;
  double total = 0;
  const auto open = [&] {
    const int count = static_cast<int>(times.size());
    if (count < options_.repeats) return count == 0 || total + total / count < left() / 4;
    return total < quick && count < 20 * options_.repeats;
  };
  while (open()) {
    const double before = seconds();
    if (!done(name, work)) return std::nullopt;
    times.push_back(seconds() - before);
    total += times.back();
  }
  return timing_of(std::move(times));
}

Timing timing_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  const auto at = [&](double share) {
    const double index = share * static_cast<double>(seconds.size() - 1);
    return seconds[static_cast<std::size_t>(std::lround(index))];
  };
  return {at(0.5), at(0.25), at(0.75), static_cast<int>(seconds.size())};
}

ReferenceShape benchmark_reference(const Scene& scene) {
  ReferenceShape result;
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy);
  try {
    result.rod = solve_reference(scene, Model::exact);
    result.agreement = error_of(scene, energy, result.rod);
  } catch (const InputError&) {
    result = {Model::energy, energy, std::nan("")};
  } catch (const ConvergenceError&) {
    result = {Model::energy, energy, std::nan("")};
  }
  return result;
}

StaticRuns::StaticRuns(const Scene& scene, const ReferenceShape& reference,
                       const BenchmarkOptions& options, Stopwatch& watch)
    : scene_(scene), reference_(reference), options_(options), watch_(watch) {
  const ForceVariant hooke;
  ForceVariant soft;
  soft.stretch_share = 1e-3;
  ForceVariant paper_law = soft;
  paper_law.law = BendingLaw::paper;
  paper_law.bookkeeping = Bookkeeping::paper;
  ForceVariant paper_chain = paper_law;
  paper_chain.stretch_share = 1;
  ForceVariant dynamic = soft;
  dynamic.stepper = Stepper::dynamic;
  const auto add = [&](Model model, const ForceVariant& variant, const std::vector<int>& sizes) {
    series_.push_back({.model = model, .variant = variant, .sizes = sizes});
  };
  const std::vector<int> points = {8, 16, 32, 64, 128, 256};
  if (reference.model == Model::exact) add(Model::exact, {}, {0});
  add(Model::energy, {}, {2, 3, 4, 6, 8, 12, 16, 24, 0});
  for (const ForceVariant& variant : {hooke, paper_chain}) add(Model::chain, variant, points);
  ForceVariant implicit;
  implicit.stepper = Stepper::implicit;
  for (const ForceVariant& variant : {soft, hooke, implicit, dynamic, paper_law}) {
    add(Model::force, variant, points);
  }
  for (const ForeignProgram& program : options.programs) {
    series_.push_back({.program = &program, .sizes = points});
  }
}

bool StaticRuns::next_round() {
  bool ran = false;
  for (StaticSeries& series : series_) {
    if (series.sizes.empty()) continue;
    ran = true;
    const int size = series.sizes.front();
    series.sizes.erase(series.sizes.begin());
    if (series.program != nullptr) {
      run_program(series, size);
    } else if (series.model == Model::exact || series.model == Model::energy) {
      run_continuous(series, size);
    } else {
      run_polygon(series, size);
    }
  }
  return ran;
}

std::vector<BenchmarkRun> StaticRuns::runs() const {
  std::vector<BenchmarkRun> all;
  for (const StaticSeries& series : series_) {
    all.insert(all.end(), series.runs.begin(), series.runs.end());
  }
  return all;
}

void StaticRuns::run_continuous(StaticSeries& series, int terms) {
  const Model model = series.model;
  energy_model::Equilibrium result;
  const std::optional<Timing> time = watch_.time(
      fmt::format("{}: {}", scene_.name, name_of({.model = model, .size = terms})), series.last_s,
      [&] { result = solve_reference(scene_, model, {.terms = terms}); });
  if (!time) return;
  series.last_s = time->median_s;
  series.runs.push_back({.scene = scene_.name,
                         .model = model,
                         .size = terms,
                         .variant = std::nullopt,
                         .time = *time,
                         .evaluations = result.evaluations,
                         .rms_over_length = model == Model::exact
                                                ? reference_.agreement
                                                : error_of(scene_, result, reference_.rod)});
}

/// Runs a polygon model with N points. Its time is predicted from the previous, smaller N. If a run
/// does not fit into the budget, larger ones do not fit either.
void StaticRuns::run_polygon(StaticSeries& series, int points) {
  const Model model = series.model;
  const std::string name = name_of({.model = model, .size = points, .variant = series.variant});
  const ForceModelSettings settings = series.variant.settings(scene_, points);
  // The limit exceeds what most series need. A series that needs more steps is reported as skipped.
  SolveOptions options{.max_steps = 60'000'000 / points};
  // A tenth of the discretisation error of the polygon with law hooke, which is about 0.1 / N^2.
  options.rest_tolerance = std::clamp(0.01 / (points * points), 1e-7, 1e-4);
  const double growth = series.last_points > 0 ? std::pow(1.0 * points / series.last_points, 3) : 1;
  Solution solution;
  const std::optional<Timing> time =
      watch_.time(fmt::format("{}: {}", scene_.name, name), series.last_s * growth, [&] {
        solution = model == Model::chain ? solve_chain(scene_, settings, options)
                                         : solve_force(scene_, settings, options);
      });
  if (!time) {
    series.sizes.clear();
    return;
  }
  series.last_s = time->median_s;
  series.last_points = points;
  series.runs.push_back(
      {.scene = scene_.name,
       .model = model,
       .size = points,
       .variant = series.variant,
       .time = *time,
       .evaluations = model == Model::chain ? solution.evaluations : solution.steps,
       .rms_over_length = error_of(scene_, solution.shape, reference_.rod)});
}

/// Runs a foreign program with N points. After a failure larger N are still tried, but not after a
/// run that reached the time limit.
void StaticRuns::run_program(StaticSeries& series, int points) {
  BenchmarkRun run{.scene = scene_.name, .program = series.program->name, .size = points};
  const double growth = series.last_points > 0 ? 1.0 * points / series.last_points : 1;
  ForeignRun result;
  std::vector<double> times;
  double total = 0;
  const auto again = [&] {
    const auto count = static_cast<double>(times.size());
    const bool time_left = total + total / count < watch_.left() / 4;
    return result.problem.empty() && count < options_.repeats && time_left;
  };
  const bool ran = watch_.run_once(
      fmt::format("{}: {}", scene_.name, name_of(run)), series.last_s * growth * growth, [&] {
        do {
          result = run_foreign(*series.program, scene_, points, options_.program_time_limit);
          times.push_back(result.seconds);
          total += result.seconds;
        } while (again());
      });
  if (!ran || result.too_long) series.sizes.clear();
  if (!ran) return;
  std::string problem = std::move(result.problem);
  if (problem.empty()) {
    try {
      run.rms_over_length =
          foreign_deviation(scene_, *result.shape, reference_.rod.sample).rms_over_length;
    } catch (const InputError& error) {
      problem = error.what();
    }
  }
  if (!problem.empty()) {
    failures_.push_back({scene_.name, series.program->name, points, std::move(problem)});
    return;
  }
  run.time = timing_of(std::move(times));
  series.last_s = run.time.median_s;
  series.last_points = points;
  series.runs.push_back(std::move(run));
}

}  // namespace dlo::compare
