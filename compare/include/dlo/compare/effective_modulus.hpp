#pragma once

#include <functional>
#include <string>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// What the optimum of an effective modulus is worth.
enum class Optimum {
  clear,
  flat,       ///< a modulus twice or half as large fits less than 10 % worse
  one_sided,  ///< the fit still improves at the end of the range that was searched
};

/// In words, for messages.
[[nodiscard]] const char* to_string(Optimum optimum);

/// The modulus E* at which the energy model comes nearest to a shape.
struct EffectiveModulus {
  double ratio = 0;                  ///< E*/E
  double rms_m = 0;                  ///< what even E* does not explain
  Optimum optimum = Optimum::clear;  ///< what `ratio` is worth
};

/// Range of E*/E that is searched.
inline constexpr double smallest_modulus_ratio = 1e-4;
/// The other end of the range.
inline constexpr double largest_modulus_ratio = 1e4;

/// Minimises the RMS distance at equal arc length over E*, everything else as in the scene: a scan
/// over the range, then GSL's Brent minimiser.
/// @throws InputError, ConvergenceError as solve_reference
[[nodiscard]] EffectiveModulus fit_effective_modulus(const Scene& scene, const Shape& shape);

/// Distance of a shape from the energy model's [m].
using ShapeDistance = std::function<double(const energy_model::Equilibrium&)>;

/// The same for any distance.
/// @param scene  the scene;  @param distance  what is minimised
/// @param state  an equilibrium of the scene that is followed both ways from E*/E = 1 to the
/// nearest
///               minimum; without one the lowest that each modulus has
/// @throws InputError, ConvergenceError as solve_reference
[[nodiscard]] EffectiveModulus fit_effective_modulus(
    const Scene& scene, const ShapeDistance& distance,
    const energy_model::Equilibrium* state = nullptr);

/// RMS distance at equal arc length.
[[nodiscard]] ShapeDistance distance_from(const Shape& shape);

}  // namespace dlo::compare
