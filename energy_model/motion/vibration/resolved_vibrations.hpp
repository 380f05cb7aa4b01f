#pragma once

#include <functional>
#include <vector>

#include "dlo/energy_model/vibrations.hpp"
#include "search/known_shape.hpp"
#include "span/span_workspace.hpp"

namespace dlo::energy_model {

/// The spans of a rod at rest with so many terms, bent out of their planes too.
using SpansAtRest = std::function<std::vector<PlacedSolution>(int terms, SpanWorkspace&)>;

/// Modes with more and more terms, until they do not change.
/// @param known  shape that `spans` has to find again; null: there is no other one
Vibrations resolved_vibrations(const Problem& problem, const Inertia& inertia,
                               const SpansAtRest& spans, const Equilibrium* known,
                               const VibrationOptions& options);

}  // namespace dlo::energy_model
