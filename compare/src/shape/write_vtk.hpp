#pragma once

#include <string>
#include <vector>

#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// A shape as a legacy ASCII VTK file of one polyline, for ParaView and load_shape: points [m], and
/// as point data arc_length_m, curvature_per_m, and tension_N where there is one.
/// @param curvature  [1/m], M;  @param tension  [N], M or none
/// @param title      second line of the file, cut to what the format allows
[[nodiscard]] std::string vtk_polyline(const Shape& shape, const std::vector<double>& curvature,
                                       const std::vector<double>& tension,
                                       const std::string& title);

}  // namespace dlo::compare
