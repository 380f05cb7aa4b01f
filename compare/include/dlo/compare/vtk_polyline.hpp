#pragma once

#include <string>

#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// A solution as a legacy ASCII VTK file of one polyline, for ParaView and load_shape: points [m],
/// and as point data arc_length_m, curvature_per_m, and tension_N where the solution has it. The
/// curvature of a polygon is that of its joints: turning angle over the mean of the two segments;
/// at an end that of the nearest joint.
/// @param title  second line of the file, cut to what the format allows
[[nodiscard]] std::string vtk_polyline(const Solution& solution, const std::string& title);

}  // namespace dlo::compare
