#pragma once

#include <limits>
#include <string>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"

namespace dlo::compare {

/// Whether friction can hold a shape.
enum class FrictionVerdict {
  none_needed,     ///< obstacles that only push hold it
  inside,          ///< the forces that it needs are inside the cones
  outside,         ///< they are not
  not_identified,  ///< see the reason
};

/// In words, for files.
template <>
struct Choices<FrictionVerdict> {
  /// In the enumeration's order.
  static constexpr Choice<FrictionVerdict> all[] = {
      {FrictionVerdict::none_needed, "none_needed", ""},
      {FrictionVerdict::inside, "inside", ""},
      {FrictionVerdict::outside, "outside", ""},
      {FrictionVerdict::not_identified, "not_identified", ""}};
};

/// What a shape that touches obstacles needs of their friction.
struct FrictionCheck {
  FrictionVerdict verdict = FrictionVerdict::not_identified;  ///< the answer
  std::string reason;  ///< why it is not identified, a clause; else empty
  /// Least factor by which the scene's coefficients have to be multiplied so that an equilibrium
  /// under forces in the cones is as near to the shape as one under any [-]; NaN if not identified.
  double factor = std::numeric_limits<double>::quiet_NaN();
  /// The same for an equilibrium whose squared distance is twice as large: what is below it a file
  /// with this scatter excludes [-].
  double least_factor = std::numeric_limits<double>::quiet_NaN();
  /// By which the polygon's segments leave these two open [-].
  double factor_error = std::numeric_limits<double>::quiet_NaN();
  /// `factor` times the coefficient, where all obstacles that are touched have one and the same
  /// [-]; else NaN.
  double coefficient = std::numeric_limits<double>::quiet_NaN();
  /// RMS distance of the shape from the nearest equilibrium under any friction [m].
  double rms_m = std::numeric_limits<double>::quiet_NaN();
};

/// The equilibria of a polygon of the scene's rod under its weight, loads, grips and forces of
/// obstacles at its nodes that touch them, inside Coulomb's cones, and which of them comes nearest
/// to the points of a shape that check_shape() has laid on its reference. Forces act on the axis.
/// Coefficients up to ten times the scene's, and up to 5, are looked at. It says nothing of whether
/// such an equilibrium is stable. Not identified: with arc lengths from nearest points or a frame
/// that was found, of rods with natural curvature, two bending stiffnesses or held twist, at
/// obstacles that yield, where the shape touches nothing or is no equilibrium, and where scatter or
/// segments leave it open.
///
/// Spatial cones are replaced by pyramids of 12 sides within them: `factor` may be too large by 3.5
/// %, which factor_error holds. In a plane they are exact.
[[nodiscard]] FrictionCheck check_friction(const Scene& scene, const ShapeCheck& check);

}  // namespace dlo::compare
