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

Shape sampled_shape(const Scene& scene, const energy_model::Equilibrium& rod) {
  const std::vector<double> s = equal_arc_lengths(scene.length, reference_samples);
  return {s, rod.sample(s).points};
}

bool is_polygon(Model model) { return model == Model::chain || model == Model::force; }

/// One run of a model.
struct SolvedRun {
  double seconds = 0;
  long evaluations = 0;  // or steps
  Shape shape;
};

SolvedRun solved_run(const Scene& scene, const StaticSeries& series, int size) {
  const Model model = series.model;
  if (is_polygon(model)) {
    const ForceModelSettings settings = series.variant.settings(scene, size);
    // The limit exceeds what most series need. A series that needs more steps is reported as
    // skipped.
    SolveOptions options{.max_steps = 60'000'000 / size};
    // A tenth of the discretisation error of the polygon with law hooke, which is about 0.1 / N^2.
    options.rest_tolerance = std::clamp(0.01 / (size * size), 1e-7, 1e-4);
    const Timer timer;
    const Solution solution = model == Model::chain ? solve_chain(scene, settings, options)
                                                    : solve_force(scene, settings, options);
    return {timer.seconds(), model == Model::chain ? solution.evaluations : solution.steps,
            solution.shape};
  }
  const Timer timer;
  const energy_model::Equilibrium rod = solve_reference(scene, model, {.terms = size});
  const double seconds = timer.seconds();
  return {seconds, rod.evaluations, sampled_shape(scene, rod)};
}

}  // namespace

bool Stopwatch::fits(const std::string& name, double predicted_s) {
  constexpr double largest_share = 0.25;
  const double remaining = left();
  if (remaining > 0 && predicted_s <= largest_share * remaining) return true;
  skipped_.push_back(
      remaining > 0
          ? fmt::format("{}: it takes about {:.2g} s, and one run gets a quarter of the {:.2g} s "
                        "that are left (--seconds)",
                        name, predicted_s, remaining)
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
                                      const std::function<double()>& work) {
  // Runs that are faster than this in total are repeated more often [s].
  constexpr double quick_run_seconds = 0.02;
  if (!fits(name, predicted_s)) return std::nullopt;
  std::vector<double> times;
  double total = 0;
  const auto open = [&] {
    const int count = static_cast<int>(times.size());
    if (count < options_.repeats) return count == 0 || total + total / count < left() / 4;
    return total < quick_run_seconds && count < 20 * options_.repeats;
  };
  while (open()) {
    if (!done(name, [&] { times.push_back(work()); })) return std::nullopt;
    total += times.back();
  }
  if (std::isnan(total)) return Timing{total, total, total, static_cast<int>(times.size())};
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
    result.agreement = error_of(scene, sampled_shape(scene, energy), result.rod);
  } catch (const ResultError&) {
    result = {Model::energy, energy, std::nan("")};
  }
  return result;
}

StaticRuns::StaticRuns(const Scene& scene, const ReferenceShape& reference,
                       const BenchmarkOptions& options, Stopwatch& watch)
    : scene_(scene), reference_(reference), options_(options), watch_(watch) {
  constexpr double share = 1e-3;  // of AE, as the paper's c_c
  const ForceVariant hooke;
  const ForceVariant soft{.stretch_share = share};
  const ForceVariant implicit{.stepper = Stepper::implicit};
  const ForceVariant dynamic{.stepper = Stepper::dynamic, .stretch_share = share};
  const ForceVariant paper_chain{.law = BendingLaw::paper, .bookkeeping = Bookkeeping::paper};
  ForceVariant paper_law = paper_chain;
  paper_law.stretch_share = share;
  const auto add = [&](Model model, const ForceVariant& variant, const std::vector<int>& sizes) {
    series_.push_back({.model = model, .variant = variant, .sizes = sizes});
  };
  const std::vector<int> points = {8, 16, 32, 64, 128, 256};
  if (reference.model == Model::exact) add(Model::exact, {}, {0});
  add(Model::energy, {}, {2, 3, 4, 6, 8, 12, 16, 24, 0});
  for (const ForceVariant& variant : {hooke, paper_chain}) add(Model::chain, variant, points);
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
    run(series, size);
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

/// Runs a model or a program with one size. If a polygon or a program does not fit into the budget
/// or throws, or a program reaches its time limit, larger ones are not run; after another failure
/// of a program they are.
void StaticRuns::run(StaticSeries& series, int size) {
  const bool is_program = series.program != nullptr;
  BenchmarkRun run{.scene = scene_.name, .model = series.model, .size = size};
  if (is_program) run.program = series.program->name;
  if (is_polygon(series.model)) run.variant = series.variant;
  SimulatorRun foreign;
  SolvedRun solved;
  const auto work = [&] {
    if (!is_program) {
      solved = solved_run(scene_, series, size);
      return solved.seconds;
    }
    foreign = run_foreign(*series.program, scene_, size, options_.program_time_limit);
    return foreign.problem.empty() ? foreign.seconds : std::nan("");
  };
  // The time is predicted to grow with N^3 for polygons and with N^2 for programs.
  const int power = is_polygon(series.model) ? 3 : is_program ? 2 : 0;
  const double growth = series.last_size > 0 ? std::pow(1.0 * size / series.last_size, power) : 1;
  const std::optional<Timing> time =
      watch_.time(fmt::format("{}: {}", scene_.name, name_of(run)), series.last_s * growth, work);
  if ((!time && power > 0) || foreign.too_long) series.sizes.clear();
  if (!time) return;
  if (is_program) {
    try {
      if (foreign.shape) {
        run.rms_over_length =
            foreign_deviation(scene_, *foreign.shape, reference_.rod.sample).rms_over_length;
      }
    } catch (const InputError& error) {
      foreign.problem = error.what();
    }
    if (!foreign.problem.empty()) {
      failures_.push_back({scene_.name, run.program, size, foreign.problem});
      return;
    }
  } else {
    run.rms_over_length = series.model == Model::exact
                              ? reference_.agreement
                              : error_of(scene_, solved.shape, reference_.rod);
  }
  if (is_program && series.last_size == 0) {
    for (const std::string& note : foreign.shape->notes) {
      notes_.push_back(fmt::format("{}: {}: {}", scene_.name, run.program, note));
    }
  }
  run.evaluations = solved.evaluations;
  run.time = *time;
  series.last_s = time->median_s;
  series.last_size = size;
  series.runs.push_back(std::move(run));
}

}  // namespace dlo::compare
