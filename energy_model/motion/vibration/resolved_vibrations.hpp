#pragma once

#include <functional>
#include <vector>

#include "dlo/energy_model/vibrations.hpp"
#include "search/known_shape.hpp"
#include "span/span_workspace.hpp"

namespace dlo::energy_model {

/// Function that returns the spans of a rod in equilibrium with a number of coefficients, all in
/// space.
using SpansAtRest = std::function<std::vector<PlacedSolution>(int terms, SpanWorkspace&)>;

/// Computes modes with an increasing number of coefficients until they do not change.
/// @param known  shape that `spans` has to reproduce; null: no comparison
Vibrations resolved_vibrations(const Problem& problem, const Inertia& inertia,
                               const SpansAtRest& spans, const Equilibrium* known,
                               const VibrationOptions& options);

}  // namespace dlo::energy_model
