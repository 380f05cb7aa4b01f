#include "dlo/compare/shape_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/number.hpp"
#include "dlo/compare/deviation.hpp"

namespace dlo::compare {
namespace {

std::string arc_range(double from, double to) {
  return fmt::format("s = {:.4g} to {:.4g} m", from, to);
}

/// Describes the parts that a file lacks at the ends of the rod; empty if it lacks none.
std::string missing_parts(const ShapeCheck& check, double least) {
  const std::vector<double>& s = check.reference.arc_length;
  std::vector<std::string> parts;
  if (s.front() > least) parts.push_back(arc_range(0, s.front()));
  if (s.back() < check.length_m - least) parts.push_back(arc_range(s.back(), check.length_m));
  return fmt::format("{}", fmt::join(parts, " and "));
}

}  // namespace

ShapeTolerance default_tolerance(double length) {
  constexpr double share = 0.01;
  return {.allowed_m = share * length, .by_default = true};
}

ShapeJudgement judge(const ShapeCheck& check, const ShapeTolerance& tolerance) {
  ShapeJudgement result;
  const double rms = tolerance.part ? check.deviation.rms_m : check.whole_rod_rms_m;
  const double largest = tolerance.part ? check.deviation.max_m : check.whole_rod_max_m;
  // A single point has no mean along the rod.
  const bool is_single = check.measured_points == 1;
  result.judged_m = is_single ? check.deviation.max_m : tolerance.largest ? largest : rms;
  const bool near = result.judged_m <= tolerance.allowed_m;
  double observed_share = check.observed_share;
  std::vector<std::string> untold;
  for (const RodPart& part : check.between) {
    if (part.interpolation_error_m <= tolerance.allowed_m) continue;
    observed_share -= (part.to_m - part.from_m) / check.length_m;
    untold.push_back(arc_range(part.from_m, part.to_m));
  }
  const bool enough = observed_share >= tolerance.least_observed_share;
  const bool determined = enough && (tolerance.part || untold.empty());
  result.verdict = !near        ? ShapeVerdict::fail
                   : determined ? ShapeVerdict::pass
                                : ShapeVerdict::undetermined;

  const double unverified = !check.unverified   ? std::numeric_limits<double>::infinity()
                            : tolerance.largest ? check.unverified->max_m
                                                : check.unverified->rms_m;
  std::vector<std::string> reasons;
  if (!near && unverified <= tolerance.allowed_m) {
    result.verdict = ShapeVerdict::undetermined;
    reasons.push_back(fmt::format("{:.4g} mm away from an equilibrium that is not verified: {}",
                                  unverified * 1e3, check.unverified->message));
  }
  if (!enough) {
    reasons.push_back(fmt::format("only {:.4g} % of the rod is observed, {:.4g} % is required",
                                  std::max(0.0, observed_share) * 100,
                                  tolerance.least_observed_share * 100));
  }
  if (!untold.empty()) {
    reasons.push_back(
        fmt::format("the points do not determine the rod at {}", fmt::join(untold, ", ")));
  }
  constexpr double rounding = 1e-6;
  const std::string missing = missing_parts(check, rounding * check.length_m);
  const bool of_deflection = tolerance.deflection_share > 0;
  const double share =
      of_deflection ? tolerance.deflection_share : tolerance.allowed_m / check.length_m;
  const char* const measure = is_single           ? "distance of the measured point"
                              : tolerance.largest ? "largest"
                                                  : "RMS";
  std::string deviation = fmt::format("{} {:.4g} mm, allowed {:.4g} mm = {:.4g} % of {}", measure,
                                      result.judged_m * 1e3, tolerance.allowed_m * 1e3, share * 100,
                                      of_deflection ? "the deflection" : "l");
  if (tolerance.by_default) deviation += ", the default";
  if (!missing.empty()) {
    deviation += tolerance.part || is_single ? "; not judged: " : ", with ";
    deviation += missing + ", which the file does not have";
  }
  reasons.push_back(std::move(deviation));
  result.reason = fmt::format("{}", fmt::join(reasons, "; "));
  return result;
}

}  // namespace dlo::compare
