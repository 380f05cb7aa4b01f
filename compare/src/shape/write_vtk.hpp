#pragma once

#include <string>
#include <vector>

#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// Quantities at a shape's points; an empty one is unknown.
struct PointFields {
  std::vector<double> curvature;  ///< [1/m], M
  std::vector<double> tension;    ///< [N], M
  Eigen::Matrix3Xd d1;            ///< first director of the rod's frame, unit, 3 x M
};

/// Formats a shape as a legacy ASCII VTK file of one polyline, for ParaView and load_shape: points
/// [m], and as point data arc_length_m and, where known, curvature_per_m, tension_N and d1.
/// @param title  second line of the file, shortened to 200 characters, in printable ASCII
[[nodiscard]] std::string vtk_polyline(const Shape& shape, const PointFields& fields,
                                       const std::string& title);

/// Formats a shape as an XML file of a VTK unstructured grid (VTU) with one polyline, in ASCII with
/// enough digits for an exact round trip: points [m], and arc_length_m as point data.
[[nodiscard]] std::string vtu_polyline(const Shape& shape);

}  // namespace dlo::compare
