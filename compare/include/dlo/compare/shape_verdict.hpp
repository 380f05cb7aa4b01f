#pragma once

#include <optional>
#include <string>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_check.hpp"

namespace dlo::compare {

/// Tolerance of a comparison.
struct ShapeTolerance {
  double allowed_m = 0;               ///< largest deviation that passes [m], > 0
  bool largest = false;               ///< whether the largest deviation is judged, not the RMS
  double least_observed_share = 0.5;  ///< share of the rod that the points have to show [-], 0 to 1
  /// Whether the file is declared to be a part of the rod, and only that part is judged. Else it is
  /// the whole rod, and missing parts count.
  bool part = false;
  bool by_default = false;  ///< whether it is default_tolerance(), not one that the user gave
  /// If > 0, check() sets allowed_m to this share of the deflection (TrivialShape) [-].
  double deflection_share = 0;
};

/// Returns the tolerance that is used if none is given: 1 % of the length, RMS.
/// @param length  of the rod [m]
[[nodiscard]] ShapeTolerance default_tolerance(double length);

/// Outcome of a comparison.
enum class ShapeVerdict {
  pass,  ///< within the tolerance, and the points determine the rod
  fail,  ///< beyond the tolerance
  /// Within the tolerance, but the points do not determine the rod; or within the tolerance of an
  /// equilibrium that is not verified; or a chain that is too coarse to judge (judge_as_chain()).
  undetermined,
};

/// Names of the verdicts in JSON.
template <>
struct Choices<ShapeVerdict> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<ShapeVerdict> all[] = {
      {ShapeVerdict::pass, "pass", "within the tolerance"},
      {ShapeVerdict::fail, "fail", "beyond the tolerance"},
      {ShapeVerdict::undetermined, "undetermined", "the points do not determine the rod"}};
};

/// Verdict on a shape.
struct ShapeJudgement {
  double judged_m = 0;  ///< deviation that was compared with the tolerance [m]
  /// Verdict on that deviation and on the part of the rod that the points show.
  ShapeVerdict verdict = ShapeVerdict::fail;
  std::string reason;  ///< clauses: every cause of a failure, or why the shape passes
  /// Whether the trivial shape (TrivialShape) would not pass as well. Empty: the shape does not
  /// pass, neither weight nor loads act, or no trivial shape was found.
  std::optional<bool> significant;

  /// Whether the verdict is `pass`.
  [[nodiscard]] bool passes() const { return verdict == ShapeVerdict::pass; }
};

/// Compares a shape's deviation with a tolerance, at every point and for every part of the rod.
/// Parts missing at the ends count with their distance from the outermost point unless the file is
/// declared to be a part. An interval between adjacent points is observed if a smooth curve through
/// the points determines it within the tolerance; unless the file is a part, all have to be
/// observed. A few points on a short part lie near any rod, so a file that shows less than
/// `least_observed_share` never passes. A shape within the tolerance that does not show enough of
/// the rod is `undetermined`, and so is a shape beyond it that is within the tolerance of
/// ShapeCheck::unverified. If a file has one measured point (ShapeCheck::measured_points), the
/// largest distance of a point is judged, not the RMS. The reason names what the file lacks.
[[nodiscard]] ShapeJudgement judge(const ShapeCheck& check, const ShapeTolerance& tolerance);

}  // namespace dlo::compare
