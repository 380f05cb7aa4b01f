#pragma once

#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/fitted_rods.hpp"
#include "wire/wire_optimum.hpp"
#include "wire/wire_problem.hpp"

namespace dlo::compare {

/// Returns the result of fit_wire(), without the prediction.
[[nodiscard]] MaterialFit wire_result(const WireProblem& problem, WireOptimum& optimum);

/// Sets FittedShape::rod of the fit's shapes.
void draw_rods(const FittedRods::Rods& rods, const std::vector<Scene>& scenes, MaterialFit& fit);

}  // namespace dlo::compare
