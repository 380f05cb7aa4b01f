#pragma once

#include <functional>
#include <vector>

#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A number of a wire, or of how one shape of it was held, that is fitted to shapes.
struct WireNumber {
  /// Its value is not in use; nothing known before is an infinite deviation.
  FittedNumber described;
  double stride = 0;  ///< of differences, in its unit
  std::function<void(Scene&, double)> change;
};

/// All that is to be found: first the logarithm of E over the scenes', then, with `density`, of the
/// density, if asked for of GJ / EI, natural curvature, then each shape's own directions and
/// positions.
/// @throws InputError if natural curvature is asked for where no clamp or plane says about which
/// axes, or GJ where no scene twists the rod
[[nodiscard]] std::vector<WireNumber> wire_numbers(const std::vector<Scene>& scenes,
                                                   const std::vector<MeasuredShape>& shapes,
                                                   const MaterialFitOptions& options, bool density);

}  // namespace dlo::compare
