#include <fmt/format.h>

#include "dlo/compare/explanation.hpp"
#include "explain/own_polygon.hpp"

namespace dlo::compare {
namespace {

/// Of a tolerance: how far a file is that is so far off because of how it was read, says nothing.
constexpr double far_beyond = 10;

}  // namespace

ShapeJudgement judge_with_chains(const Scene& scene, const ShapeCheck& check,
                                 const ShapeTolerance& tolerance) {
  ShapeJudgement result = judge(check, tolerance);
  if (result.passes()) return result;
  const Shape& shape = check.alignment.shape;
  for (const OwnPolygon& chain : own_polygons(scene, shape, Springs::as_the_rod)) {
    const double distance = tolerance.largest ? chain.max_m : chain.rms_m;
    if (!(distance <= right_chain * tolerance.allowed_m)) continue;
    result.reason = fmt::format("right for {}, {:.3g} mm away ({})",
                                words_of(chain.clamp, shape.points.cols() - 1) + and_springs(chain),
                                distance * 1e3, tolerance.largest ? "largest" : "RMS") +
                    fmt::format(", allowed {:.4g} mm = {:g} of the tolerance",
                                right_chain * tolerance.allowed_m * 1e3, right_chain) +
                    fmt::format("; the rod itself is {:.4g} mm = {:.3g} % of l away, all of it ",
                                result.judged_m * 1e3, result.judged_m / check.length_m * 100) +
                    "discretisation";
    result.verdict = ShapeVerdict::pass;
    break;
  }
  return result;
}

ShapeJudgement with_explanation(ShapeJudgement judgement,
                                const std::vector<Explanation>& explanations,
                                const ShapeTolerance& tolerance) {
  if (judgement.passes() || explanations.empty()) return judgement;
  const Explanation& best = explanations.front();
  const bool is_misread = judgement.judged_m > far_beyond * tolerance.allowed_m;
  if (best.kind == ExplanationKind::file && is_misread && best.rms_m <= tolerance.allowed_m) {
    judgement.reason = fmt::format("RMS {:.4g} mm if {}; as it was read: {}", best.rms_m * 1e3,
                                   best.cause, judgement.reason);
    return judgement;
  }
  judgement.reason += fmt::format(
      "; it would be {:.4g} mm (RMS) if {}", best.rms_m * 1e3,
      best.kind == ExplanationKind::discretisation ? "it were " + best.cause : best.cause);
  return judgement;
}

}  // namespace dlo::compare
