#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/force_model_settings.hpp"

namespace dlo::compare {
namespace {

/// Returns the largest deviation over all scenes of rigid segments with the chosen parameters.
double worst_of_segments(const ForceModelFit& fit) {
  const bool paper = fit.settings.law == BendingLaw::paper;
  const StiffnessRule chosen = paper ? StiffnessRule::fitted : StiffnessRule::physical;
  double worst = 0;
  for (const RuleDeviations& rule : fit.rules) {
    if (rule.rule != chosen) continue;
    for (const double rms : rule.rms_over_length) worst = std::max(worst, rms);
  }
  return worst;
}

std::string discretisation_shortfall(const ForceModelFit& fit, double segments) {
  const int N = fit.settings.points;
  if (fit.settings.law == BendingLaw::paper) {
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
                                      : "the target, although it is the largest N tried",
                     segments * 100);
}

std::string stretch_shortfall(const ForceModelFit& fit, double stretch) {
  if (fit.c_c_is_physical) {
    return fmt::format(
        "c_c is A E: the rod stretches as its material does, which the energy model neglects. The "
        "stretch alone causes {:.3g} %, which no N removes; the smallest reachable target is about "
        "this value (smaller deviations at some N are errors that cancel)",
        stretch * 100);
  }
  return fmt::format(
      "the given c_c stretches the rod, which alone makes {:.3g} %: no N reaches "
      "the target",
      stretch * 100);
}

}  // namespace

std::vector<std::string> ForceModelFit::shortfall_reasons() const {
  std::vector<std::string> reasons;
  if (reaches_target()) return reasons;
  const double segments = worst_of_segments(*this);
  const double stretch = std::ranges::max(stretch_rms_over_length);
  if (segments > target) reasons.push_back(discretisation_shortfall(*this, segments));
  if (stretch > target) reasons.push_back(stretch_shortfall(*this, stretch));
  if (reasons.empty()) {
    reasons.push_back(fmt::format(
        "rigid segments ({:.3g} %) and stretch ({:.3g} %) together are too much: more --points",
        segments * 100, stretch * 100));
  }
  return reasons;
}

}  // namespace dlo::compare
