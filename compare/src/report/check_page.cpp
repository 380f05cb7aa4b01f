#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/number.hpp"
#include "judge/budget_parts.hpp"
#include "report/page.hpp"

namespace dlo::compare {
namespace {

std::string millimetres(double metres) { return page_number(metres * 1e3) + "\u00a0mm"; }

std::string page_percent(double share) { return page_number(share * 100) + "\u00a0%"; }

/// Returns the best explanation of a shape that fails the check; empty if there is none.
std::string cause_of(const CheckResult& result) {
  if (result.passes() || result.explanations.empty()) return {};
  const Explanation& best = result.explanations.front();
  return fmt::format("It would be {} away if {}{}.", millimetres(best.rms_m),
                     best.kind == ExplanationKind::discretisation ? "it were " : "", best.cause);
}

std::string summary_of(const std::string& what, double judged_m, const ShapeTolerance& tolerance) {
  return fmt::format("{} is {} away from the rod ({}). Allowed: {}{}.", what, millimetres(judged_m),
                     tolerance.largest ? "largest distance" : "RMS",
                     millimetres(tolerance.allowed_m),
                     tolerance.by_default ? ", 1\u00a0% of the length, by default" : "");
}

std::vector<PageNumber> distances(const Deviation& d) {
  return {
      {"RMS distance", millimetres(d.rms_m), page_percent(d.rms_over_length) + " of the length"},
      {"largest", millimetres(d.max_m), fmt::format("at s = {:.4g} m", d.max_at_m)}};
}

PageTable cause_table() { return {"What would explain it", {"cause", "RMS then"}, {}}; }

const char* verdict_of(bool passes) { return passes ? "pass" : "fail"; }

}  // namespace

PageResult page_result(const CheckResult& result) {
  const EffectiveModulus& modulus = result.check.effective_modulus;
  const bool identified = is_identified(modulus.optimum) && !result.supersedes_modulus;
  const std::string why_not =
      result.supersedes_modulus
          ? "not meaningful: a cause explains the shape better than any stiffness"
      : modulus.why_none.empty() ? "not identified"
                                 : modulus.why_none;
  PageResult page{
      .title = result.check.scene,
      .passes = result.passes(),
      .verdict = to_string(result.judgement.verdict),
      .summary = summary_of(result.check.file, result.judgement.judged_m, result.tolerance),
      .cause = cause_of(result),
      .numbers = distances(result.check.deviation),
      .pictures = {},
      .table = cause_table()};
  const std::string both = other_stiffness_within(result);
  if (!both.empty()) page.summary += " " + both + ".";
  if (!result.judgement.significant.value_or(true)) {
    page.summary +=
        " Not significant for stiffness or weight: the rod without weight and loads would pass "
        "too.";
  }
  page.numbers.push_back({"E*/E", identified ? page_number(modulus.ratio) : "\u2013",
                          identified ? millimetres(modulus.rms_m) + " away with it" : why_not});
  for (const Explanation& explanation : result.explanations) {
    page.table.rows.push_back({explanation.cause, millimetres(explanation.rms_m)});
  }
  return page;
}

PageResult page_result(const MotionCheck& check) {
  const double length = check.scene.length;
  const auto left = [&](double metres) { return millimetres(shown(metres, length)); };
  const double rms_m = shown(check.errors.rms_m, length);
  const bool lags = std::isfinite(check.lag);
  PageResult page{
      .title = check.scene.name,
      .passes = check.passes,
      .verdict = verdict_of(check.passes),
      .summary = summary_of(check.file, shown(check.judged_m, length), check.tolerance),
      .cause = {},
      .numbers = {{"RMS distance", millimetres(rms_m),
                   page_percent(rms_m / length) + " of the length"},
                  {"worst frame", left(check.worst().rms_m),
                   fmt::format("at {:.4g} s", check.worst().time)},
                  {"lag", lags ? page_number(check.lag * 1e3) + "\u00a0ms" : "\u2013",
                   lags ? left(check.lag_rms_m) + " away without it" : "none that explains much"}},
      .pictures = {},
      .table = cause_table()};
  for (const MotionCause& cause : check.causes) {
    page.table.rows.push_back({cause.words, left(cause.rms_m)});
  }
  if (!check.passes && !check.causes.empty()) {
    const MotionCause& best = check.causes.front();
    page.cause = fmt::format("It would be {} away if {}.", left(best.rms_m), best.words);
  }
  return page;
}

PageResult page_result(const Comparison& comparison) {
  const ShapeTolerance tolerance = default_tolerance(comparison.length);
  const bool passes = comparison.deviation.rms_m <= tolerance.allowed_m;
  const EffectiveModulus& modulus = comparison.effective_modulus;
  const bool identified = is_identified(modulus.optimum);
  PageResult page{
      .title = comparison.scene,
      .passes = passes,
      .verdict = verdict_of(passes),
      .summary = summary_of(
          fmt::format("The force model (law {}, bookkeeping {}, N = {})",
                      to_string(comparison.settings.law),
                      to_string(comparison.settings.bookkeeping), comparison.settings.points),
          comparison.deviation.rms_m, tolerance),
      .cause = {},
      .numbers = distances(comparison.deviation),
      .pictures = {},
      .table = {
          "Error budget: shares of the deviation add up to 100 %", {"part", "RMS", "share"}, {}}};
  if (!comparison.unverified.empty()) {
    page.summary += fmt::format(" The energy model is not verified: {}.", comparison.unverified);
  }
  page.numbers.push_back({"E*/E", identified ? page_number(modulus.ratio) : "\u2013",
                          identified                 ? millimetres(modulus.rms_m) + " away with it"
                          : modulus.why_none.empty() ? "not identified"
                                                     : modulus.why_none});
  const auto parts = shown_parts(comparison);
  for (const auto& [name, part] : parts) {
    page.table.rows.push_back({name, millimetres(part->rms_m), page_percent(part->share)});
  }
  const auto largest =
      std::ranges::max_element(parts, {}, [](const auto& part) { return part.second->share; });
  if (!passes && largest != parts.end()) {
    page.cause = fmt::format("Largest part of the deviation: {}, {}.", largest->first,
                             page_percent(largest->second->share));
  }
  return page;
}

}  // namespace dlo::compare
