#pragma once

#include <functional>
#include <limits>
#include <string>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Significance of an effective modulus E*.
enum class Optimum {
  none,   ///< there is no E*, see EffectiveModulus::missing_reason
  clear,  ///< E* is identified, and it explains the deviation
  /// E* is identified, but it explains less than `clear_optimum_share` of the mean square
  /// deviation, or leaves more than the RMS displacement of the rod from straight
  /// (optimum_given_displacement)
  partial,
  /// A modulus twice or half as large fits less than 10 % worse, or worse by at most the energy
  /// model's own error (modulus_resolution).
  flat,
  /// The fit still improves where the search ended: at the end of the range, or where the followed
  /// equilibrium ends or bifurcates.
  one_sided,
};

/// Names of the values in messages.
template <>
struct Choices<Optimum> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<Optimum> all[] = {{Optimum::none, "none", ""},
                                            {Optimum::clear, "clear", ""},
                                            {Optimum::partial, "partial", ""},
                                            {Optimum::flat, "flat", ""},
                                            {Optimum::one_sided, "one-sided", ""}};
};

/// Whether E* is identified, even if it does not explain the deviation.
[[nodiscard]] constexpr bool is_identified(Optimum optimum) {
  return optimum == Optimum::clear || optimum == Optimum::partial;
}

/// Whether E*/E is searched.
enum class ModulusSearch { yes, no };

/// The modulus E* whose equilibrium is nearest to a shape.
struct EffectiveModulus {
  double ratio = std::numeric_limits<double>::quiet_NaN();  ///< E*/E; NaN without one
  double rms_m = std::numeric_limits<double>::quiet_NaN();  ///< RMS distance that remains at E*
  /// Share of the mean square distance at E that E* removes: 1 - (rms_m / rms at E)^2; NaN if the
  /// distance at E is at most the energy model's own error.
  double explained_share = std::numeric_limits<double>::quiet_NaN();
  Optimum optimum = Optimum::none;         ///< significance of `ratio`
  std::string missing_reason = "skipped";  ///< why there is no E*; empty if there is one
  /// Whether the followed equilibrium ends or bifurcates at E*: beyond it the rod is on another
  /// branch, so that E* is the limit of the branch and not a measure of the material.
  bool at_bifurcation = false;
  int solves = 0;  ///< number of solves of the energy model
};

/// Returns the significance of E* in view of the RMS displacement of the rod from straight [m]
/// (NaN: there is no straight shape). An optimum that is `clear` but leaves more than that
/// displacement becomes `partial`, since a straight rod would then be as near.
/// fit_effective_modulus() has applied it.
[[nodiscard]] Optimum optimum_given_displacement(const EffectiveModulus& modulus,
                                                 double movement_m);

/// Smallest E*/E that is searched.
inline constexpr double smallest_modulus_ratio = 1e-4;
/// Largest E*/E that is searched.
inline constexpr double largest_modulus_ratio = 1e4;
/// Share of the mean square distance that a clear optimum explains: E* leaves at most half of the
/// RMS distance, so that the explained part (sqrt(3)/2 of the RMS, as a field orthogonal to the
/// rest) is at least 1.7 times the remainder.
inline constexpr double clear_optimum_share = 0.75;
/// RMS distance below which no E* is identified, divided by the length: the energy model's own
/// error.
inline constexpr double modulus_resolution = 1e-8;

/// Minimises the RMS distance at equal arc length over E*; all other properties are the scene's.
///
/// The scene's equilibrium is followed from E*/E = 1 in both directions, in steps of a quarter of a
/// decade, until the distance has not decreased for half a decade. GSL's Brent minimiser then
/// minimises the mean square. Every modulus is solved from the nearest one that is known. A shape
/// counts as the same equilibrium if it is stable and moves by less than a tenth of the length, in
/// smaller steps if necessary; else the equilibrium ends there. The time limit is for the whole
/// search. If it is exceeded, if the distance changes by at most the energy model's own error, or
/// if the equilibrium is lost at the moduli next to the scene's, there is no E*, and the result
/// states why.
/// @throws InputError, ConvergenceError as solve_reference for the scene's own modulus
[[nodiscard]] EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape,
                                                     const SolveOptions& options = {});

/// Distance of a shape from an equilibrium of the energy model [m].
using ShapeDistance = std::function<double(const energy_model::Equilibrium&)>;

/// Minimises any distance over E*, as fit_effective_modulus() of a shape does.
/// @param scene  the scene;  @param distance  distance that is minimised
/// @param state  equilibrium of the scene that is followed
[[nodiscard]] EffectiveModulus fit_effective_modulus(const Scene& scene,
                                                     const ShapeDistance& distance,
                                                     const energy_model::Equilibrium& state,
                                                     const SolveOptions& options = {});

/// Returns a function that computes the RMS distance of a shape from an equilibrium at equal arc
/// length.
[[nodiscard]] ShapeDistance distance_from(const Shape& shape);

}  // namespace dlo::compare
