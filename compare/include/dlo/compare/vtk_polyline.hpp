#pragma once

#include <string>

#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// A solution as a legacy ASCII VTK file of one polyline, for ParaView and load_shape: points [m],
/// and as point data arc_length_m, curvature_per_m, and tension_N where the solution has it.
/// @param title  second line of the file, cut to what the format allows
[[nodiscard]] std::string vtk_polyline(const Solution& solution, const std::string& title);

}  // namespace dlo::compare
