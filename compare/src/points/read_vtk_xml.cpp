#include "points/read_vtk_xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/xml.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/polyline.hpp"
#include "points/vtk_array.hpp"

namespace dlo::compare {
namespace {

/// A text in which appended bytes, which may be any, are cut out.
struct Cut {
  std::string text;
  std::string_view appended;
};

Cut cut_appended(std::string_view text, const std::string& file) {
  const std::size_t element = text.find("<AppendedData");
  if (element == std::string_view::npos) return {std::string(text), {}};
  const std::size_t open = text.find('>', element);
  const std::size_t begin = open == std::string_view::npos ? open : text.find('_', open);
  const std::size_t end = text.rfind("</AppendedData>");
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) {
    throw InputError(
        fmt::format("{}: AppendedData that is cut off (allowed: an underscore, the "
                    "data, and the element's end)",
                    file));
  }
  std::string rest(text.substr(0, open + 1));
  rest += text.substr(end);
  return {std::move(rest), text.substr(begin + 1, end - begin - 1)};
}

class VtkXmlReader {
 public:
  VtkXmlReader(std::string_view text, const std::string& file)
      : cut_(cut_appended(text, file)), xml_(cut_.text, file) {}

  [[nodiscard]] RawShape read() {
    const pugi::xml_node root = xml_.root();
    if (std::string_view(root.name()) != "VTKFile") {
      xml_.fail(root, "is no shape (allowed: VTKFile, of type PolyData or UnstructuredGrid)");
    }
    read_encoding(root);
    const std::string type = root.attribute("type").value();
    const bool is_grid = type == "UnstructuredGrid";
    if (!is_grid && type != "PolyData") {
      xml_.fail(root, "type", "is not read (allowed: PolyData or UnstructuredGrid)");
    }
    const pugi::xml_node piece = piece_of(root, type);
    const std::size_t count = count_of(piece, "NumberOfPoints");
    RawShape points = read_points(piece, count);
    read_point_data(piece.child("PointData"), count, points);
    const std::vector<std::size_t> order =
        is_grid ? read_grid(piece, count) : read_lines(piece, count);
    return order.empty() ? points : in_order(points, order);
  }

 private:
  void read_encoding(const pugi::xml_node& root) {
    const auto choice = [&](const char* attribute, std::initializer_list<const char*> allowed) {
      const std::string value = root.attribute(attribute).as_string(*allowed.begin());
      const auto* found = std::find(allowed.begin(), allowed.end(), value);
      if (found == allowed.end()) {
        xml_.fail(root, attribute, fmt::format("(allowed: {})", fmt::join(allowed, ", ")));
      }
      return found - allowed.begin();
    };
    encoding_.big_endian = choice("byte_order", {"LittleEndian", "BigEndian"}) == 1;
    encoding_.header_bytes = choice("header_type", {"UInt32", "UInt64"}) == 1 ? 8 : 4;
    encoding_.packed = choice("compressor", {"", "vtkZLibDataCompressor"}) == 1;
    const pugi::xml_node appended = root.child("AppendedData");
    const std::string form = appended.attribute("encoding").as_string("base64");
    if (form != "raw" && form != "base64") {
      xml_.fail(appended, "encoding", "unknown (allowed: raw, base64)");
    }
    encoding_.appended_base64 = form == "base64";
    encoding_.appended = cut_.appended;
  }

  [[nodiscard]] std::size_t count_of(const pugi::xml_node& piece, const char* attribute) const {
    const std::string_view text = piece.attribute(attribute).as_string("0");
    const auto count = as_number<std::size_t>(text);
    if (!count || *count > static_cast<std::size_t>(most_shape_points)) {
      xml_.fail(piece, attribute, fmt::format("(allowed: 0 to {})", most_shape_points));
    }
    return *count;
  }

  /// The one with points.
  [[nodiscard]] pugi::xml_node piece_of(const pugi::xml_node& root, const std::string& type) const {
    pugi::xml_node found;
    for (const pugi::xml_node& piece : root.child(type.c_str()).children("Piece")) {
      if (count_of(piece, "NumberOfPoints") == 0) continue;
      if (found) xml_.fail(piece, "is a second piece with points (allowed: one)");
      found = piece;
    }
    if (!found) xml_.fail(root, "has no Piece with points (allowed: one)");
    return found;
  }

  [[nodiscard]] RawShape read_points(const pugi::xml_node& piece, std::size_t count) const {
    const pugi::xml_node array = piece.child("Points").child("DataArray");
    if (!array) xml_.fail(piece, "has no Points with a DataArray");
    RawShape raw;
    raw.points = vectors(array, count);
    return raw;
  }

  [[nodiscard]] std::vector<std::array<double, 3>> vectors(const pugi::xml_node& array,
                                                           std::size_t count) const {
    if (array.attribute("NumberOfComponents").as_string("3") != std::string_view("3")) {
      xml_.fail(array, "NumberOfComponents", "(allowed: 3)");
    }
    const std::vector<double> numbers = vtk_numbers(xml_, array, encoding_, 3 * count);
    std::vector<std::array<double, 3>> result;
    result.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      result.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
    }
    return result;
  }

  void read_point_data(const pugi::xml_node& data, std::size_t count, RawShape& raw) const {
    for (const pugi::xml_node& array : data.children("DataArray")) {
      const std::string_view name = array.attribute("Name").value();
      if (name == "arc_length_m") {
        raw.arc_length = vtk_numbers(xml_, array, encoding_, count);
        raw.in_metres = true;
      } else if (name == "d1") {
        raw.d1 = vectors(array, count);
      }
    }
  }

  [[nodiscard]] std::vector<std::size_t> read_lines(const pugi::xml_node& piece,
                                                    std::size_t points) const {
    for (const char* other : {"NumberOfVerts", "NumberOfStrips", "NumberOfPolys"}) {
      if (count_of(piece, other) > 0) xml_.fail(piece, other, "(allowed: lines, no other cells)");
    }
    return read_cells(piece.child("Lines"), points);
  }

  [[nodiscard]] std::vector<std::size_t> read_grid(const pugi::xml_node& piece,
                                                   std::size_t points) const {
    const pugi::xml_node cells = piece.child("Cells");
    constexpr std::size_t line = 3;
    constexpr std::size_t polyline = 4;
    constexpr std::size_t most_type = 256;
    if (const pugi::xml_node types = array_of(cells, "types")) {
      for (const std::size_t type : vtk_indices(xml_, types, encoding_, most_type)) {
        if (type == line || type == polyline) continue;
        xml_.fail(types, fmt::format("\"types\": a cell of type {} (allowed: {}, VTK_LINE, and {}, "
                                     "VTK_POLY_LINE)",
                                     type, line, polyline));
      }
    }
    return read_cells(cells, points);
  }

  [[nodiscard]] static pugi::xml_node array_of(const pugi::xml_node& cells, const char* name) {
    return cells.find_child_by_attribute("DataArray", "Name", name);
  }

  /// Indices of the points along the polyline; none without cells.
  [[nodiscard]] std::vector<std::size_t> read_cells(const pugi::xml_node& cells,
                                                    std::size_t points) const {
    const pugi::xml_node ends = array_of(cells, "offsets");
    const pugi::xml_node indices = array_of(cells, "connectivity");
    if (!ends || !indices) return {};
    const std::vector<std::size_t> along = vtk_indices(xml_, indices, encoding_, points);
    std::vector<std::size_t> order;
    std::size_t begin = 0;
    for (const std::size_t end : vtk_indices(xml_, ends, encoding_, along.size() + 1)) {
      if (end < begin) xml_.fail(ends, "\"offsets\": must not fall");
      join_cell({along.begin() + static_cast<long>(begin), along.begin() + static_cast<long>(end)},
                order, xml_.where(indices));
      begin = end;
    }
    return order;
  }

  Cut cut_;
  XmlFile xml_;
  VtkEncoding encoding_;
};

}  // namespace

RawShape read_vtk_xml_shape(std::string_view text, const std::string& file) {
  return VtkXmlReader(text, file).read();
}

}  // namespace dlo::compare
