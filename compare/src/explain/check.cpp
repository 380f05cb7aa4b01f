#include "dlo/compare/check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/number.hpp"
#include "dlo/compare/error.hpp"
#include "explain/segment_starts.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

std::string point_text(const Eigen::Vector3d& point) {
  const double large = point.norm();
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", shown(point.x(), large), shown(point.y(), large),
                     shown(point.z(), large));
}

ShapeTestOutcome test_shape(const Shape& shape, const Scene& scene, ToleranceShare tolerance,
                            bool largest) {
  if (!(tolerance.share > 0)) {
    throw std::invalid_argument(
        fmt::format("tolerance of a shape = {}, must be > 0, a share of the {}", tolerance.share,
                    tolerance.of_deflection ? "deflection" : "length"));
  }
  MeasuredShape measured;
  try {
    measured = shape_of(shape.points, shape.arc_length, "the shape");
    (void)shape_of_file(measured, scene.length);
  } catch (const InputError& error) {
    return {false, error.what()};
  }
  const CheckResult result =
      check(scene, measured,
            {.tolerance =
                 ShapeTolerance{.allowed_m = tolerance.share * scene.length,
                                .largest = largest,
                                .deflection_share = tolerance.of_deflection ? tolerance.share : 0},
             .shape = {.modulus = ModulusSearch::no}});
  const ShapeCheck& c = result.check;
  return {result.passes(),
          fmt::format("{}\n  largest {:.4g} mm at s = {:.4g} m (point {}), {} m instead of {} m",
                      result.judgement.reason, c.deviation.max_m * 1e3, c.deviation.max_at_m,
                      c.worst_point, point_text(c.worst_position),
                      point_text(c.rod.sample(std::vector{c.deviation.max_at_m}).points.col(0)))};
}

bool is_loaded(const Scene& scene) {
  return scene.gravity.norm() > 0 || !scene.loads.empty() || !scene.distributed_loads.empty() ||
         scene.drag;
}

/// Sets whether a verdict "pass" is significant, and explains it if it is not.
void judge_significance(const ShapeCheckOptions& options,
                        const std::optional<TrivialShape>& trivial, CheckResult& result) {
  if (!trivial) return;
  result.deflection_m = trivial->deflection_m;
  const bool trivial_passes =
      judge(check_trivial_shape(*trivial, result.scene, result.check, options), result.tolerance)
          .passes();
  result.judgement.significant = !trivial_passes;
  if (!trivial_passes) return;
  result.judgement.reason +=
      "; not significant for stiffness or weight: the rod without weight and loads would pass too";
}

}  // namespace

std::string other_stiffness_within(const CheckResult& result) {
  const EffectiveModulus& modulus = result.check.effective_modulus;
  constexpr double least_modulus_change = 0.05;
  // The shape passes as the rod, not only as a chain.
  const bool is_near = judge(result.check, result.tolerance).passes();
  const bool is_significant = result.judgement.significant.value_or(true);
  if (!is_near || !is_significant || !is_identified(modulus.optimum) ||
      std::abs(modulus.ratio - 1) < least_modulus_change) {
    return {};
  }
  const double at_E =
      result.tolerance.part ? result.check.deviation.rms_m : result.check.whole_rod_rms_m;
  return fmt::format(
      "E*/E = {:.3g} does not contradict the verdict: the distance is {:.3g} mm at E* and {:.3g} "
      "mm at E, both within the tolerance",
      modulus.ratio, modulus.rms_m * 1e3, at_E * 1e3);
}

CheckResult check(const Scene& scene, const MeasuredShape& shape, const CheckRequest& request) {
  const MeasuredShape whole = complete_segment_starts(scene, shape, request.shape.pose);
  CheckResult result{.scene = scene,
                     .check = check_shape(scene, whole, request.shape),
                     .tolerance = request.tolerance.value_or(default_tolerance(scene.length)),
                     .pose = request.shape.pose,
                     .notes = whole.notes};
  std::optional<TrivialShape> trivial;
  const auto find_trivial = [&] {
    if (!trivial) trivial = trivial_shape(scene, result.check.rod, request.shape.solve);
  };
  if (result.tolerance.deflection_share > 0) {
    find_trivial();
    result.deflection_m = required_deflection(scene, trivial);
    result.tolerance.allowed_m = result.tolerance.deflection_share * result.deflection_m;
  }
  const ChainJudgement judged = judge_as_chain(scene, result.check, result.tolerance);
  result.judgement = judged.judgement;
  if (result.passes() && is_loaded(scene)) {
    find_trivial();
    judge_significance(request.shape, trivial, result);
  }
  if (result.passes()) result.check.hint.clear();
  if (request.explaining == Explaining::no) return result;
  if (result.judgement.verdict != ShapeVerdict::fail) {
    if (judged.chain) {
      result.superseding_cause = cause_better_than_stiffness(result.check, {*judged.chain});
    }
    return result;
  }
  result.explanations = explain_shape(scene, whole, result.check, request.shape);
  result.judgement = with_explanation(result.judgement, result.explanations, result.tolerance);
  result.superseding_cause = cause_better_than_stiffness(result.check, result.explanations);
  return result;
}

ShapeTestOutcome shape_near(const Shape& shape, const Scene& scene, ToleranceShare tolerance) {
  return test_shape(shape, scene, tolerance, false);
}

ShapeTestOutcome shape_within(const Shape& shape, const Scene& scene, ToleranceShare tolerance) {
  return test_shape(shape, scene, tolerance, true);
}

}  // namespace dlo::compare
