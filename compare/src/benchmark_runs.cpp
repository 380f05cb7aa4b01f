#include "benchmark_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

constexpr int reference_samples = 101;

double error_of(const Scene& scene, const Shape& shape, const energy_model::Equilibrium& rod) {
  return rms(shape.arc_length, shape.points - rod.sample(shape.arc_length).points) / scene.length;
}

double error_of(const Scene& scene, const energy_model::Equilibrium& a,
                const energy_model::Equilibrium& b) {
  const std::vector<double> s = equal_arc_lengths(scene.length, reference_samples);
  return error_of(scene, {s, a.sample(s).points}, b);
}

void add_continuous(const Scene& scene, const ReferenceShape& reference, Stopwatch& watch,
                    std::vector<BenchmarkRun>& runs) {
  energy_model::Equilibrium result;
  const auto add = [&](Model model, int terms) {
    BenchmarkRun run{.scene = scene.name, .model = model, .size = terms};
    const std::optional<Timing> time =
        watch.time(fmt::format("{}: {}{}", scene.name, to_string(model),
                               terms > 0 ? fmt::format(", K = {}", terms) : ""),
                   0, [&] { result = solve_reference(scene, model, {.terms = terms}); });
    if (!time) return;
    run.time = *time;
    run.work = result.evaluations;
    run.rms_over_length =
        model == Model::exact ? reference.agreement : error_of(scene, result, reference.rod);
    if (model == Model::energy && terms == 0) run.setting = "K as needed";
    runs.push_back(std::move(run));
  };
  if (reference.model == Model::exact) add(Model::exact, 0);
  for (const int terms : {2, 3, 4, 6, 8, 12, 16, 24, 0}) add(Model::energy, terms);
}

/// One polygon over N, each predicted from the one before.
void add_polygons(const Scene& scene, const ReferenceShape& reference, Model model,
                  const ForceVariant& variant, Stopwatch& watch, std::vector<BenchmarkRun>& runs) {
  double last_s = 0;
  int last_points = 0;
  for (const int points : {8, 16, 32, 64, 128, 256}) {
    const ForceModelSettings settings = variant.settings(scene, points);
    // Longer than most series: what takes more steps is said to be skipped.
    SolveOptions options{.max_steps = 60'000'000 / points};
    // A tenth of the hooke polygon's error at this N, about 0.1 / N^2.
    options.rest_tolerance = std::clamp(0.01 / (points * points), 1e-7, 1e-4);
    const double growth = last_points > 0 ? std::pow(1.0 * points / last_points, 3) : 1;
    Solution solution;
    const std::optional<Timing> time =
        watch.time(fmt::format("{}: {}, N = {}, {}", scene.name, to_string(model), points,
                               variant.text(model)),
                   last_s * growth, [&] {
                     solution = model == Model::chain ? solve_chain(scene, settings, options)
                                                      : solve_force(scene, settings, options);
                   });
    if (!time) break;
    last_s = time->median_s;
    last_points = points;
    runs.push_back({.scene = scene.name,
                    .model = model,
                    .size = points,
                    .setting = variant.text(model),
                    .time = *time,
                    .work = model == Model::chain ? solution.evaluations : solution.steps,
                    .rms_over_length = error_of(scene, solution.shape, reference.rod)});
  }
}

}  // namespace

double Stopwatch::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

bool Stopwatch::fits(const std::string& name, double predicted_s) {
  constexpr double largest_share = 0.25;
  if (predicted_s <= largest_share * left() && left() > 0) return true;
  skipped_.push_back(
      fmt::format("{} (predicted {:.2g} s, {:.2g} s left)", name, predicted_s, left()));
  return false;
}

bool Stopwatch::done(const std::string& name, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    skipped_.push_back(fmt::format("{} ({})", name, error.what()));
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
  constexpr double quick = 0.02;  // what is quicker in total is repeated more often
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

std::vector<BenchmarkRun> static_runs(const Scene& scene, const ReferenceShape& reference,
                                      Stopwatch& watch) {
  std::vector<BenchmarkRun> runs;
  add_continuous(scene, reference, watch, runs);
  const ForceVariant hooke;
  ForceVariant soft;
  soft.stretch_share = 1e-3;
  ForceVariant paper_law = soft;
  paper_law.law = Law::paper;
  paper_law.bookkeeping = Bookkeeping::paper;
  ForceVariant paper_chain = paper_law;
  paper_chain.stretch_share = 1;
  ForceVariant dynamic = soft;
  dynamic.stepper = StepperName::dynamic;
  add_polygons(scene, reference, Model::chain, hooke, watch, runs);
  add_polygons(scene, reference, Model::chain, paper_chain, watch, runs);
  for (const ForceVariant& variant : {soft, hooke, dynamic, paper_law}) {
    add_polygons(scene, reference, Model::force, variant, watch, runs);
  }
  return runs;
}

ForceModelSettings ForceVariant::settings(const Scene& scene, int points) const {
  ForceModelSettings result;
  result.points = points;
  result.law = law;
  result.bookkeeping = bookkeeping;
  result.stepper = stepper;
  result.c_c = stretch_share * scene.axial_stiffness();
  return result;
}

std::string ForceVariant::text(Model model) const {
  std::string result = fmt::format("{}, {}", to_string(law), to_string(bookkeeping));
  if (model == Model::chain) return result;  // no steps, and rigid or nearly so
  return fmt::format("{}, {}, c_c = {}", result, to_string(stepper),
                     stretch_share == 1 ? "AE" : fmt::format("AE/{:g}", 1 / stretch_share));
}

}  // namespace dlo::compare
