#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "decode/binary.hpp"
#include "decode/xml.hpp"

namespace dlo::compare {

/// How the arrays of one of VTK's XML files are written.
struct VtkEncoding {
  bool big_endian = false;
  std::size_t header_bytes = 4;  ///< of each number before the data, 4 or 8
  bool packed = false;           ///< by zlib
  bool appended_base64 = false;  ///< else the appended bytes are as they are
  std::string_view appended;     ///< behind the underscore of AppendedData
};

/// The numbers of a DataArray.
/// @param count  that there have to be
/// @throws InputError naming file, line and array
[[nodiscard]] std::vector<double> vtk_numbers(const XmlFile& xml, const pugi::xml_node& array,
                                              const VtkEncoding& encoding, std::size_t count);

/// The same as indices below `end`, as many as there are.
[[nodiscard]] std::vector<std::size_t> vtk_indices(const XmlFile& xml, const pugi::xml_node& array,
                                                   const VtkEncoding& encoding, std::size_t end);

}  // namespace dlo::compare
