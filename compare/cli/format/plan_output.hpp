#pragma once

#include <string>

#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// What is assumed of a scene's rod, as a sentence; empty if nothing is.
[[nodiscard]] std::string assumption_text(const compare::Scene& scene);

/// Bounds of a rod of layers, and which it is; empty of another.
[[nodiscard]] std::string layers_text(const compare::Scene& scene);

/// What a rest shape leaves of its points; empty of a scene without one.
[[nodiscard]] std::string rest_shape_text(const compare::Scene& scene);

/// A plan as a person reads it, with a blank line after it.
[[nodiscard]] std::string plan_text(const compare::Plan& plan, const compare::Scene& scene);

[[nodiscard]] Json plan_json(const compare::Plan& plan);

}  // namespace dlo::cli
