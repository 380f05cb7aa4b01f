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

/// What an explanation is about.
enum class ExplanationKind {
  file,            ///< how the file says the shape
  discretisation,  ///< a chain of hinges instead of a rod
  scene,           ///< another scene than the one given
};

/// In words, for files.
template <>
struct Choices<ExplanationKind> {
  /// In the enumeration's order.
  static constexpr Choice<ExplanationKind> all[] = {
      {ExplanationKind::file, "file", ""},
      {ExplanationKind::discretisation, "discretisation", ""},
      {ExplanationKind::scene, "scene", ""}};
};

/// What may be wrong with a shape, or with the scene that it is held against.
struct Explanation {
  std::string cause;                              ///< a clause: "gripper 1 is rotated by 5 deg"
  double rms_m = 0;                               ///< of the whole rod, were it so
  int numbers = 0;                                ///< that were fitted to the shape
  ExplanationKind kind = ExplanationKind::scene;  ///< what it is about
  double max_m = 0;  ///< of a discretisation: the largest deviation of a point from it
};

/// Looks for a single thing that would make a shape right: of the file (its unit, its axes, points
/// that leave the rod, what it is stretched by, noise), of its simulator (a chain of hinges instead
/// of a rod; an unstable equilibrium) or of the scene (stiffness or weight, the direction of
/// gravity, the length, the place and direction of a gripper, a pin that is a clamp or the reverse,
/// natural curvature, twist). Each is fitted to the shape in the state that it was compared with,
/// by Gauss-Newton steps whose derivatives are differences between solved rods.
/// @param check  of the same scene and shape
/// @return those that leave no more than half of the deviation, the best first: one that fits with
///         fewer numbers before one that fits hardly better with more; empty where none does
[[nodiscard]] std::vector<Explanation> explain_shape(const Scene& scene, const MeasuredShape& shape,
                                                     const ShapeCheck& check,
                                                     const ShapeCheckOptions& options);

/// What explains a shape better than any stiffness, where E* is identified: it leaves less than
/// half of what E* leaves, with two fitted numbers less than a quarter, and so on. E* is then no
/// measure of the material.
/// @param explanations  of explain_shape(), for the same check
[[nodiscard]] std::optional<Explanation> better_than_stiffness(
    const ShapeCheck& check, const std::vector<Explanation>& explanations);

/// Share of the tolerance within which a chain's points have to be to be right for a chain, in the
/// measure that the tolerance is of.
inline constexpr double right_chain = 0.25;

/// A judgement of a file that may be a chain of hinges.
struct ChainJudgement {
  ShapeJudgement judgement;          ///< its verdict
  std::optional<Explanation> chain;  ///< which the file was judged as; empty: as the rod
};

/// Judges as judge(), and passes a file that is a chain of hinges at rest. That needs all of this:
/// the file's polyline is as long as the rod within the tolerance; `least_seen_share` of the rod is
/// observed; the file is within `right_chain` of the tolerance of a chain of its own points at
/// rest; check.rod is a stable, certified equilibrium; and the chain's distance from it is an error
/// of discretisation, which decreases with shorter segments as the chain's clamps make it decrease.
/// A chain whose distance decreases otherwise is too coarse to judge, and `undetermined`.
[[nodiscard]] ChainJudgement judge_as_chain(const Scene& scene, const ShapeCheck& check,
                                            const ShapeTolerance& tolerance);

/// With the best explanation named where the shape fails; whether it does is no matter of these.
/// What is wrong with the file comes first if nothing else is wrong and the shape is more than ten
/// tolerances away.
/// @param explanations  of explain_shape(), for the same check
[[nodiscard]] ShapeJudgement with_explanation(ShapeJudgement judgement,
                                              const std::vector<Explanation>& explanations,
                                              const ShapeTolerance& tolerance);

}  // namespace dlo::compare
