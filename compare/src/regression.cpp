#include "dlo/compare/regression.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/error.hpp"
#include "markup.hpp"

namespace dlo::compare {
namespace {

RegressionVerdict verdict_of(double expected, double measured,
                             const RegressionTolerance& tolerance) {
  const double margin = tolerance.absolute + tolerance.relative * expected;
  if (measured < expected - margin) return RegressionVerdict::better;
  // The negation makes a NaN worse.
  return measured <= expected + margin ? RegressionVerdict::same : RegressionVerdict::worse;
}

std::string percent(const std::optional<double>& share) {
  return share ? fmt::format("{:.4g} %", *share * 100) : std::string("none");
}

void compare_errors(RegressionResult& result, const RegressionTolerance& tolerance) {
  const ShapeErrors& expected = *result.expected;
  const ShapeErrors& measured = *result.measured;
  using Share = std::optional<double>;
  const std::array<std::tuple<const char*, Share, Share>, 3> errors = {
      {{"RMS", expected.rms, measured.rms},
       {"largest", expected.max, measured.max},
       {"tip", expected.tip, measured.tip}}};
  result.verdict = RegressionVerdict::same;
  for (const auto& [what, before, now] : errors) {
    if (!before && !now) continue;
    if (!result.message.empty()) result.message += ", ";
    const RegressionVerdict verdict =
        before && now ? verdict_of(*before, *now, tolerance) : RegressionVerdict::worse;
    const char* mark = verdict == RegressionVerdict::same ? "" : to_string(verdict);
    result.message += fmt::format("{} {} of l (baseline {}){}{}", what, percent(now),
                                  percent(before), *mark != '\0' ? " " : "", mark);
    if (verdict == RegressionVerdict::worse) result.verdict = verdict;
    if (verdict == RegressionVerdict::better && result.verdict == RegressionVerdict::same) {
      result.verdict = verdict;
    }
  }
}

}  // namespace

BaselineCase measure_case(const Scene& scene, Model model, const SolveOptions& options) {
  const Solution solution = solve(scene, model, options);
  const energy_model::Equilibrium energy = solve_reference(scene, Model::energy, options);
  const Deviation d = shape_deviation(scene, solution.shape, energy.sample);
  BaselineCase result{scene.name,
                      model,
                      scene.force_model.law,
                      scene.force_model.bookkeeping,
                      scene.force_model.points,
                      {d.rms_over_length, d.max_m / scene.length, std::nullopt}};
  if (std::isfinite(d.tip_m)) result.errors.tip = d.tip_m / scene.length;
  return result;
}

const char* to_string(RegressionVerdict verdict) {
  switch (verdict) {
    case RegressionVerdict::same:
      return "same";
    case RegressionVerdict::better:
      return "better";
    case RegressionVerdict::worse:
      return "worse";
    case RegressionVerdict::not_in_baseline:
      return "not in the baseline";
    case RegressionVerdict::not_measured:
      return "not measured";
    case RegressionVerdict::not_solved:
      break;
  }
  return "not solved";
}

bool failed(RegressionVerdict verdict) {
  return verdict != RegressionVerdict::same && verdict != RegressionVerdict::better;
}

std::vector<RegressionResult> judge_regression(const std::vector<BaselineCase>& baseline,
                                               const std::vector<MeasuredCase>& measured,
                                               const RegressionTolerance& tolerance) {
  const auto allowed = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!allowed(tolerance.relative) || !allowed(tolerance.absolute)) {
    throw std::invalid_argument(
        fmt::format("judge_regression: tolerance relative = {}, absolute = {}, must be >= 0",
                    tolerance.relative, tolerance.absolute));
  }
  std::map<std::string, RegressionResult> results;
  for (const BaselineCase& entry : baseline) {
    RegressionResult& result = results[entry.name()];
    result.expected = entry.errors;
    result.verdict = RegressionVerdict::not_measured;
    result.message = "in the baseline, but no scene given is this case";
  }
  std::map<std::string, int> seen;
  for (const MeasuredCase& measurement : measured) {
    const std::string name = measurement.entry.name();
    if (++seen[name] > 1) {
      throw InputError(fmt::format(
          "{}: two scenes are this case (allowed: a name of its own for each scene)", name));
    }
    RegressionResult& result = results[name];
    result.message.clear();
    if (!measurement.problem.empty()) {
      result.verdict = RegressionVerdict::not_solved;
      result.message = measurement.problem;
      continue;
    }
    result.measured = measurement.entry.errors;
    if (result.expected) {
      compare_errors(result, tolerance);
    } else {
      result.verdict = RegressionVerdict::not_in_baseline;
      result.message = fmt::format("RMS {} of l, not in the baseline (--update adds it)",
                                   percent(result.measured->rms));
    }
  }
  std::vector<RegressionResult> sorted;
  for (auto& [name, result] : results) {
    result.name = name;
    sorted.push_back(std::move(result));
  }
  return sorted;
}

std::string junit_xml(const std::vector<RegressionResult>& results) {
  int failures = 0;
  int errors = 0;
  std::string cases;
  for (const RegressionResult& result : results) {
    cases += fmt::format("    <testcase classname=\"dlo.regress\" name=\"{}\"",
                         escape_markup(result.name));
    if (!failed(result.verdict)) {
      cases += fmt::format(">\n      <system-out>{}: {}</system-out>\n    </testcase>\n",
                           to_string(result.verdict), escape_markup(result.message));
      continue;
    }
    const bool error = result.verdict == RegressionVerdict::not_solved;
    ++(error ? errors : failures);
    cases += fmt::format(">\n      <{0} type=\"{1}\" message=\"{2}\"/>\n    </testcase>\n",
                         error ? "error" : "failure", to_string(result.verdict),
                         escape_markup(result.message));
  }
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\"", results.size(), failures, errors);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {0}>\n"
      "  <testsuite name=\"dlo regress\" {0}>\n{1}  </testsuite>\n</testsuites>\n",
      counts, cases);
}

}  // namespace dlo::compare
