#pragma once

#include <optional>
#include <string>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_check.hpp"

namespace dlo::compare {

/// What a deviation is held against.
struct ShapeTolerance {
  double allowed_m = 0;           ///< largest deviation that passes [m], > 0
  bool largest = false;           ///< the largest deviation is held against it, not the RMS
  double least_seen_share = 0.5;  ///< of the rod that the points have to tell [-], 0 to 1
  /// The file is said to be a part of the rod: only what it has is judged. Else it is the whole
  /// rod, and what is missing counts.
  bool part = false;
  bool by_default = false;  ///< nobody has asked for it: default_tolerance()
  /// If > 0, check() sets allowed_m to this share of the deflection (TrivialShape) [-].
  double deflection_share = 0;
};

/// What a shape is judged by where no tolerance is given: 1 % of the length, RMS.
/// @param length  of the rod [m]
[[nodiscard]] ShapeTolerance default_tolerance(double length);

/// Outcome of a comparison.
enum class ShapeVerdict {
  pass,          ///< within the tolerance, and the points determine the rod
  fail,          ///< beyond the tolerance
  undetermined,  ///< within the tolerance, but the points do not determine the rod
};

/// As JSON spells them.
template <>
struct Choices<ShapeVerdict> {
  /// In the enumeration's order.
  static constexpr Choice<ShapeVerdict> all[] = {
      {ShapeVerdict::pass, "pass", "within the tolerance"},
      {ShapeVerdict::fail, "fail", "beyond the tolerance"},
      {ShapeVerdict::undetermined, "undetermined", "the points do not determine the rod"}};
};

/// Whether a shape is right.
struct ShapeJudgement {
  double judged_m = 0;  ///< the deviation that was held against the tolerance [m]
  ShapeVerdict verdict = ShapeVerdict::fail;  ///< on that deviation and on what the points show
  std::string reason;  ///< one clause: of all that made it fail, or why it passes
  /// Whether the trivial shape (TrivialShape) would not pass as well. Empty: the shape does not
  /// pass, neither weight nor loads act, or no trivial shape was found.
  std::optional<bool> significant;

  /// Whether the verdict is `pass`.
  [[nodiscard]] bool passes() const { return verdict == ShapeVerdict::pass; }
};

/// Holds a compared shape against a tolerance: every point and every part of the rod. Parts missing
/// at the ends count with their distance from the outermost point unless the file is said to be a
/// part; a part between neighbouring points is seen if a smooth curve through points there tells it
/// within the tolerance, and the whole rod has to be. Points that cover next to nothing of the rod
/// lie near it whatever its shape is, so less than `least_seen_share` is never a pass. A shape
/// within the tolerance that does not show enough of the rod is `undetermined`. Of a file with one
/// measured point (ShapeCheck::measured_points) that point's distance is judged. The reason names
/// what the file lacks.
[[nodiscard]] ShapeJudgement judge(const ShapeCheck& check, const ShapeTolerance& tolerance);

}  // namespace dlo::compare
