#pragma once

#include <string>
#include <string_view>

#include "points/raw_shape.hpp"

namespace dlo::compare {

/// Reads a polyline from VTK's XML formats PolyData (VTP) and UnstructuredGrid (VTU, cells VTK_LINE
/// and VTK_POLY_LINE): one piece with points; arrays as ASCII, base64 or appended, plain or packed
/// by zlib, in either order of bytes. The arrays arc_length_m, by which a file is in metres, and d1
/// of its point data count too. @throws InputError naming file, line and array
[[nodiscard]] RawShape read_vtk_xml_shape(std::string_view text, const std::string& file);

}  // namespace dlo::compare
