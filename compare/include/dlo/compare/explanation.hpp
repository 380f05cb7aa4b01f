#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/shape_verdict.hpp"

namespace dlo::compare {

/// Subject of an explanation.
enum class ExplanationKind {
  file,            ///< how the file describes the shape
  discretisation,  ///< a chain of hinges instead of a rod
  scene,           ///< a scene that differs from the given one
};

/// Names of the kinds in files.
template <>
struct Choices<ExplanationKind> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<ExplanationKind> all[] = {
      {ExplanationKind::file, "file", ""},
      {ExplanationKind::discretisation, "discretisation", ""},
      {ExplanationKind::scene, "scene", ""}};
};

/// A possible error of a shape, or of the scene that it is compared with.
struct Explanation {
  std::string cause;  ///< a clause: "gripper 1 is rotated by 5 deg"
  /// RMS deviation of the whole rod if the cause is right, of a chain or a part that of the points.
  double rms_m = 0;
  int numbers = 0;  ///< number of fitted quantities, or of errors of the file beyond the first
  ExplanationKind kind = ExplanationKind::scene;  ///< subject of the explanation
  double max_m = 0;  ///< largest deviation from a chain whose springs are not fitted; else 0
};

/// Searches for a cause that explains a shape's deviation. Causes of the file, one or several at a
/// time: noise and, if its frame is known, its unit, its axes, its origin, the order of its points,
/// points off the rod, a scaling, a rotation. Causes of its simulator: a chain of hinges instead of
/// a rod, an unstable equilibrium. Causes of the scene, one at a time: stiffness or weight, size
/// and direction of gravity, the length, position and direction of a gripper, a pin that is a clamp
/// or the reverse, natural curvature, twist. Those of the scene, except the length, are fitted to
/// the shape, from the compared equilibrium, by Gauss-Newton steps whose derivatives are
/// differences between solved rods. The search ends at options.solve.time_limit.
/// @param check  result for the same scene and shape
/// @return causes that leave at most half of the deviation, the best first: a cause with more
/// numbers precedes another one only if each additional number halves the remaining deviation;
/// empty if there is none
[[nodiscard]] std::vector<Explanation> explain_shape(const Scene& scene, const MeasuredShape& shape,
                                                     const ShapeCheck& check,
                                                     const ShapeCheckOptions& options);

/// Returns the cause that explains a shape better than any stiffness: it leaves less than half of
/// the deviation that E* leaves, with two fitted numbers less than a quarter, and so on. E* is then
/// not a measure of the material. Returns std::nullopt if there is no such cause, or if E* is not
/// identified.
/// @param explanations  result of explain_shape(), for the same check
[[nodiscard]] std::optional<Explanation> cause_better_than_stiffness(
    const ShapeCheck& check, const std::vector<Explanation>& explanations);

/// Largest deviation of a file from a chain of hinges at which the file counts as that chain,
/// divided by the tolerance and in the measure of the tolerance (RMS or largest) [-].
inline constexpr double chain_match_tolerance = 0.25;

/// Verdict on a file that may be a chain of hinges.
struct ChainJudgement {
  ShapeJudgement judgement;  ///< verdict on the file
  /// Chain as which the file was judged; empty: judged as the rod.
  std::optional<Explanation> chain;
};

/// Judges as judge(), but also passes a file that is a chain of hinges at rest. All of these are
/// required: the file's polyline is as long as the rod within the tolerance; `least_observed_share`
/// of the rod is observed; the file is within `chain_match_tolerance` of the tolerance from a chain
/// at rest with the same number of points; check.rod is a stable, certified equilibrium; and the
/// chain's distance from it is an error of discretisation, which decreases with shorter segments at
/// the rate that the chain's clamps imply, or is within the bound of make_plan(). If the distance
/// decreases at another rate, the chain is too coarse to judge, and the verdict is `undetermined`.
[[nodiscard]] ChainJudgement judge_as_chain(const Scene& scene, const ShapeCheck& check,
                                            const ShapeTolerance& tolerance);

/// Adds the best explanation to the reason of a verdict that is not `pass`; the verdict itself is
/// unchanged. The explanation comes first if it is a cause in the file that brings the RMS
/// deviation within the tolerance, and the shape is more than ten tolerances away.
/// @param explanations  result of explain_shape(), for the same check
[[nodiscard]] ShapeJudgement with_explanation(ShapeJudgement judgement,
                                              const std::vector<Explanation>& explanations,
                                              const ShapeTolerance& tolerance);

}  // namespace dlo::compare
