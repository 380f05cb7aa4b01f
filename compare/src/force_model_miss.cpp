#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/force_model_fit.hpp"

namespace dlo::compare {
namespace {

double largest_of(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double result = 0;
  for (std::size_t i = begin; i < end; ++i) result = std::max(result, values[i]);
  return result;
}

/// Of the rigid segments with the parameters that were chosen, worst of all scenes.
double worst_of_segments(const ForceModelFit& fit) {
  const bool paper = fit.settings.law == Law::paper;
  const StiffnessRule chosen = paper ? StiffnessRule::fitted : StiffnessRule::physical;
  double worst = 0;
  for (const RuleDeviations& rule : fit.rules) {
    if (rule.rule != chosen) continue;
    for (const double rms : rule.rms_over_length) worst = std::max(worst, rms);
  }
  return worst;
}

std::string segments_miss(const ForceModelFit& fit, double segments) {
  const int N = fit.settings.points;
  if (fit.settings.law == Law::paper) {
    return fmt::format(
        "law paper: with {} c_b rigid segments are {:.3g} % off; --law hooke comes nearer with N",
        fit.c_b_was_given ? "the given" : "the nearest", segments * 100);
  }
  if (fit.points_were_given) {
    return fmt::format(
        "N = {} is too few: its rigid segments are {:.3g} % off without any stretch; dlo calibrate "
        "without --points takes N from the target",
        N, segments * 100);
  }
  return fmt::format("N = {} is too few for {}: its rigid segments are {:.3g} % off", N,
                     fit.holdouts > 0 ? "all scenes (hold-out scenes do not choose it)"
                                      : "the target, and the most that is tried",
                     segments * 100);
}

std::string stretch_miss(const ForceModelFit& fit, double stretch) {
  if (fit.c_c_is_physical) {
    return fmt::format(
        "c_c is A E: the rod stretches as its material does, which the energy model leaves out. "
        "That alone makes {:.3g} %, which no N takes away; the smallest target within reach is "
        "about that (less at some N is errors that cancel)",
        stretch * 100);
  }
  return fmt::format(
      "the given c_c stretches the rod, which alone makes {:.3g} %: no N reaches "
      "the target",
      stretch * 100);
}

}  // namespace

bool ForceModelFit::reached() const { return std::max(worst(), worst_holdout()) <= target; }

double ForceModelFit::worst() const {
  return largest_of(stepped_rms_over_length, 0, stepped_rms_over_length.size() - holdouts);
}
double ForceModelFit::worst_holdout() const {
  const std::size_t all = stepped_rms_over_length.size();
  return largest_of(stepped_rms_over_length, all - holdouts, all);
}

std::vector<std::string> ForceModelFit::why_missed() const {
  std::vector<std::string> reasons;
  if (reached()) return reasons;
  const double segments = worst_of_segments(*this);
  const double stretch =
      *std::max_element(stretch_rms_over_length.begin(), stretch_rms_over_length.end());
  if (segments > target) reasons.push_back(segments_miss(*this, segments));
  if (stretch > target) reasons.push_back(stretch_miss(*this, stretch));
  if (reasons.empty()) {
    reasons.push_back(fmt::format(
        "rigid segments ({:.3g} %) and stretch ({:.3g} %) together are too much: more --points",
        segments * 100, stretch * 100));
  }
  return reasons;
}

}  // namespace dlo::compare
