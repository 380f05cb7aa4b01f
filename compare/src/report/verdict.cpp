#include "report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "judge/budget_parts.hpp"
#include "report/html.hpp"
#include "report/tables.hpp"

namespace dlo::compare {
namespace {

/// Least and largest of some numbers.
class Extent {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    least_ = std::min(least_, value);
    largest_ = std::max(largest_, value);
    ++count_;
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] std::string text(double scale = 1) const {
    const std::string from = page_number(least_ * scale);
    const std::string to = page_number(largest_ * scale);
    return from == to ? from : from + " to " + to;
  }

 private:
  double least_ = HUGE_VAL;
  double largest_ = -HUGE_VAL;
  int count_ = 0;
};

using LawAndBookkeeping = std::pair<BendingLaw, Bookkeeping>;

LawAndBookkeeping group_of(const Comparison& c) { return {c.settings.law, c.settings.bookkeeping}; }

/// Comparisons of each law and bookkeeping, in the order of the report.
std::vector<std::vector<const Comparison*>> groups_of(const Report& report) {
  std::vector<std::vector<const Comparison*>> groups;
  for (const SceneReport& scene : report.scenes) {
    for (const Comparison& c : scene.comparisons) {
      const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& other) {
        return group_of(*other.front()) == group_of(c);
      });
      if (group == groups.end()) {
        groups.push_back({&c});
      } else {
        group->push_back(&c);
      }
    }
  }
  return groups;
}

std::string largest_part(const Budget& b) {
  const NamedPart& largest = *std::ranges::max_element(
      budget_parts(), {}, [&](const NamedPart& part) { return (b.*part.of).share; });
  return fmt::format("{}, with {:.0f}\u00a0% of the deviation", largest.words,
                     (b.*largest.of).share * 100);
}

void say_shapes(const Report& report, std::vector<std::string>& verdict) {
  for (const auto& group : groups_of(report)) {
    Extent rms;
    Extent ratio;
    std::ptrdiff_t right = 0;
    for (const Comparison* c : group) {
      rms.add(c->deviation.rms_over_length);
      if (is_identified(c->effective_modulus.optimum)) ratio.add(c->effective_modulus.ratio);
      if (c->deviation.rms_over_length <= report.options.tolerance) ++right;
    }
    const Comparison& worst = **std::max_element(
        group.begin(), group.end(), [](const Comparison* a, const Comparison* b) {
          return a->deviation.rms_over_length < b->deviation.rms_over_length;
        });
    // Where the fit is flat or at its range's end, E* says nothing.
    const std::string modulus =
        ratio.empty() ? "not identified in any" : ratio.text() + " where it is identified";
    verdict.push_back(
        fmt::format("Law {}, bookkeeping {}: {} of {} shapes are right within {} of the length. "
                    "RMS {} % of the "
                    "length, E*/E at rest {}. Worst is {}; the main reason is {}.",
                    to_string(worst.settings.law), to_string(worst.settings.bookkeeping), right,
                    group.size(), page_percent(report.options.tolerance), rms.text(100),
                    ratio.count() == static_cast<int>(group.size()) ? ratio.text() : modulus,
                    worst.scene, largest_part(worst.budget)));
  }
}

void say_neglected(const Report& report, std::vector<std::string>& verdict) {
  for (const SceneReport& scene : report.scenes) {
    if (scene.comparisons.empty()) continue;
    for (const std::string& what : scene.comparisons.front().force.neglected) {
      verdict.push_back(fmt::format(
          "{}: {} the {} that the scene has.", scene.file.scene.name,
          what == "friction" ? "both models neglect" : "the force model neglects", what));
    }
  }
}

void say_claim_of_a_third(const Report& report, std::vector<std::string>& verdict) {
  constexpr int poses_of_the_paper = 3;
  if (!report.paper || report.printed_weight.empty()) return;
  Extent rest;
  Extent own;
  Extent printed;
  for (const SceneHistory& entry : report.printed_weight) {
    printed.add(time_at_ratio(entry.history.times, 1. / 3));
    for (const SceneReport& scene : report.scenes) {
      if (!scene.history || scene.history->scene != entry.scene) continue;
      rest.add(scene.history->rest.ratio);
      own.add(time_at_ratio(scene.history->history.times, 1. / 3));
    }
  }
  if (rest.empty() || own.empty() || printed.empty()) return;
  verdict.push_back(fmt::format(
      "The paper says that its shapes look like the energy model's for E/3. At rest E*/E is {} in "
      "{}. It is 1/3 on the way there, after {} s of simulated time ({} s with the "
      "weight that Table 5 prints); the paper's simulations took 28\u00a0s.",
      rest.text(),
      rest.count() == poses_of_the_paper
          ? "its three poses"
          : fmt::format("{} of its {} poses", rest.count(), poses_of_the_paper),
      own.text(), printed.text()));
}

void say_speed(const Report& report, std::vector<std::string>& verdict) {
  if (!report.benchmark) return;
  for (const SceneBenchmark& scene : report.benchmark->scenes) {
    if (!scene.energy_at_1e6 || !scene.force_at_1e3) continue;
    const BenchmarkRun& energy = scene.runs[*scene.energy_at_1e6];
    const BenchmarkRun& force = scene.runs[*scene.force_at_1e3];
    const double ratio = force.time.median_s / energy.time.median_s;
    verdict.push_back(fmt::format(
        "Speed, {} (Γ = {}): the energy model at 1e-6 of the length ({}, {} ms) is {} times {} the "
        "best force model at 1e-3 ({}, {} ms).",
        scene.scene, page_number(scene.gamma), name_of(energy),
        page_number(energy.time.median_s * 1e3), page_number(ratio >= 1 ? ratio : 1 / ratio),
        ratio >= 1 ? "faster than" : "slower than", name_of(force),
        page_number(force.time.median_s * 1e3)));
  }
}

void say_stability(const Report& report, std::vector<std::string>& verdict) {
  Extent ratio;
  if (report.map) {
    for (const MapColumn& column : report.map->columns)
      ratio.add(column.measured / column.predicted);
  }
  if (!ratio.empty()) {
    verdict.push_back(fmt::format(
        "The measured limit of c_F is {} times the predicted one: the prediction is {}.",
        ratio.text(), ratio.least() >= 1 ? "safe" : "NOT safe"));
  }
  std::vector<Stepper> steppers;
  for (const StabilityResult& result : report.hard_cases) {
    if (std::find(steppers.begin(), steppers.end(), result.stepper) == steppers.end()) {
      steppers.push_back(result.stepper);
    }
  }
  std::string passes;
  for (const Stepper stepper : steppers) {
    int passed = 0;
    int answerable = 0;
    for (const StabilityResult& result : report.hard_cases) {
      if (result.stepper != stepper || result.outcome == Outcome::refused) continue;
      ++answerable;
      if (result.outcome == Outcome::pass) ++passed;
    }
    passes += fmt::format("{}{} {} of {}", passes.empty() ? "" : ", ", to_string(stepper), passed,
                          answerable);
  }
  if (!passes.empty()) verdict.push_back("Hard cases passed, by stepper: " + passes + ".");
}

}  // namespace

std::optional<ReportSummary> report_summary(const Report& report) {
  ReportSummary result;
  double worst = -1;
  for (std::size_t i = 0; i < report.scenes.size(); ++i) {
    if (report.scenes[i].comparisons.empty()) continue;
    const Comparison& own = report.scenes[i].comparisons.front();
    const double off = own.deviation.rms_over_length;
    ++result.count;
    if (off <= report.options.tolerance) ++result.right;
    if (!(off > worst)) continue;
    worst = off;
    result.worst = i;
    result.main_reason = largest_part(own.budget);
  }
  return result.count > 0 ? std::optional(result) : std::nullopt;
}

std::vector<std::string> report_verdict(const Report& report) {
  std::vector<std::string> verdict;
  for (const std::string& failure : report.failures) {
    verdict.push_back("Not computed: " + failure);
  }
  say_shapes(report, verdict);
  say_neglected(report, verdict);
  say_claim_of_a_third(report, verdict);
  say_speed(report, verdict);
  say_stability(report, verdict);
  return verdict;
}

}  // namespace dlo::compare
