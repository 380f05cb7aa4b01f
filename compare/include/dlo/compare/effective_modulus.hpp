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

/// What the optimum of an effective modulus is worth.
enum class Optimum {
  none,       ///< there is no E*, see EffectiveModulus::why_none
  clear,      ///< E* is identified, and it explains the deviation
  partial,    ///< E* is identified, but it explains less than `clear_share` of the mean square
              ///< deviation, or leaves more than the rod's own way from straight
              ///< (without_small_movement)
  flat,       ///< a modulus twice or half as large fits less than 10 % worse, or no worse than the
              ///< energy model's own error
  one_sided,  ///< the fit still improves where the search ended: at the end of the range, or where
              ///< the equilibrium that was followed ends or bifurcates
};

/// In words, for messages.
template <>
struct Choices<Optimum> {
  /// In the enumeration's order.
  static constexpr Choice<Optimum> all[] = {{Optimum::none, "none", ""},
                                            {Optimum::clear, "clear", ""},
                                            {Optimum::partial, "partial", ""},
                                            {Optimum::flat, "flat", ""},
                                            {Optimum::one_sided, "one-sided", ""}};
};

/// E* itself is identified, whether or not it explains the deviation.
[[nodiscard]] constexpr bool is_identified(Optimum optimum) {
  return optimum == Optimum::clear || optimum == Optimum::partial;
}

/// Whether E*/E is looked for.
enum class ModulusSearch { yes, no };

/// The modulus E* at which the energy model comes nearest to a shape.
struct EffectiveModulus {
  double ratio = std::numeric_limits<double>::quiet_NaN();  ///< E*/E; NaN without one
  double rms_m = std::numeric_limits<double>::quiet_NaN();  ///< what even E* does not explain
  /// Of the mean square distance at E, the share that E* takes away: 1 - (rms_m / rms at E)^2;
  /// NaN where the distance at E is no more than the energy model's own error.
  double explained_share = std::numeric_limits<double>::quiet_NaN();
  Optimum optimum = Optimum::none;   ///< what `ratio` is worth
  std::string why_none = "skipped";  ///< why there is no E*; empty if there is one
  /// At E* the equilibrium that is followed ends or bifurcates: beyond it the rod is in another
  /// state, so E* is where that begins and no measure of the material.
  bool at_bifurcation = false;
  int solves = 0;  ///< of the energy model
};

/// What an optimum is worth beside the RMS way of the rod from straight [m] (NaN: it has no
/// straight shape): one that is `clear` but leaves more than that is `partial`, since a rod that
/// does not bend at all is then as near. fit_effective_modulus() has applied it.
[[nodiscard]] Optimum without_small_movement(const EffectiveModulus& modulus, double movement_m);

/// Range of E*/E that is searched.
inline constexpr double smallest_modulus_ratio = 1e-4;
/// The other end of the range.
inline constexpr double largest_modulus_ratio = 1e4;
/// Share of the mean square distance that a clear optimum explains: E* leaves half of the RMS or
/// less, so that what it explains (sqrt(3)/2 of the RMS, as a field orthogonal to the rest) is at
/// least 1.7 times what it leaves.
inline constexpr double clear_share = 0.75;
/// RMS distance below which nothing is identified, share of the length: the energy model's own
/// error.
inline constexpr double modulus_resolution = 1e-8;

/// Minimises the RMS distance at equal arc length over E*, everything else as in the scene.
///
/// The scene's equilibrium is followed from E*/E = 1 to both sides in steps of a quarter of a
/// decade, each until the distance has not got less for half a decade; then GSL's Brent minimiser
/// of the mean square. Every modulus is solved from the nearest one that is known, and a shape
/// counts as the same equilibrium if it is stable and moves by less than a tenth of the length, in
/// smaller steps if need be; else the equilibrium ends there. The time limit is for the whole
/// search. Beyond it, and where the distance changes by no more than the energy model's own error,
/// there is no E*, and the result says why.
/// @throws InputError, ConvergenceError as solve_reference for the scene's own modulus
[[nodiscard]] EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape,
                                                     const SolveOptions& options = {});

/// Distance of a shape from the energy model's [m].
using ShapeDistance = std::function<double(const energy_model::Equilibrium&)>;

/// The same for any distance.
/// @param scene  the scene;  @param distance  what is minimised
/// @param state  the equilibrium of the scene that is followed
[[nodiscard]] EffectiveModulus fit_effective_modulus(const Scene& scene,
                                                     const ShapeDistance& distance,
                                                     const energy_model::Equilibrium& state,
                                                     const SolveOptions& options = {});

/// RMS distance at equal arc length.
[[nodiscard]] ShapeDistance distance_from(const Shape& shape);

}  // namespace dlo::compare
