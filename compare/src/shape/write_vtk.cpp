#include "shape/write_vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace dlo::compare {
namespace {

/// Replaces characters other than printable ASCII and limits the length: VTK allows 255 characters
/// per line.
std::string vtk_title(std::string title) {
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  constexpr std::size_t longest_title = 200;
  if (title.size() > longest_title) title.resize(longest_title);
  return title;
}

}  // namespace

std::string vtk_polyline(const Shape& shape, const PointFields& fields, const std::string& title) {
  const Eigen::Matrix3Xd& points = shape.points;
  std::string text =
      fmt::format("# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
                  vtk_title(title), points.cols());
  const auto out = std::back_inserter(text);
  const auto put_vectors = [&](const Eigen::Matrix3Xd& vectors) {
    for (const auto& v : vectors.colwise()) {
      fmt::format_to(out, "{:.17g} {:.17g} {:.17g}\n", v.x(), v.y(), v.z());
    }
  };
  put_vectors(points);
  fmt::format_to(out, "LINES 1 {}\n{}", points.cols() + 1, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) fmt::format_to(out, " {}", i);
  std::vector<std::pair<const char*, const std::vector<double>*>> scalars;
  scalars.emplace_back("arc_length_m", &shape.arc_length);
  if (!fields.curvature.empty()) scalars.emplace_back("curvature_per_m", &fields.curvature);
  if (!fields.tension.empty()) scalars.emplace_back("tension_N", &fields.tension);
  const bool has_frame = fields.d1.cols() > 0;
  fmt::format_to(out, "\nPOINT_DATA {}\nFIELD rod {}\n", points.cols(), scalars.size() + has_frame);
  for (const auto& [name, values] : scalars) {
    fmt::format_to(out, "{} 1 {} double\n{:.17g}\n", name, values->size(),
                   fmt::join(*values, "\n"));
  }
  if (has_frame) {
    fmt::format_to(out, "d1 3 {} double\n", fields.d1.cols());
    put_vectors(fields.d1);
  }
  return text;
}

std::string vtu_polyline(const Shape& shape) {
  const Eigen::Matrix3Xd& points = shape.points;
  constexpr int polyline_cell_type = 4;  // VTK_POLY_LINE
  std::string rows;
  std::string indices;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    rows += fmt::format("{} {} {}\n", points(0, i), points(1, i), points(2, i));
    indices += fmt::format("{}{}", i == 0 ? "" : " ", i);
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{0}\" NumberOfCells=\"1\">\n<Points>\n"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n{1}</DataArray>\n"
      "</Points>\n<Cells>\n"
      "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n{2}\n</DataArray>\n"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{0}</DataArray>\n"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{3}</DataArray>\n"
      "</Cells>\n<PointData>\n"
      "<DataArray type=\"Float64\" Name=\"arc_length_m\" format=\"ascii\">\n{4}\n</DataArray>\n"
      "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
      points.cols(), rows, indices, polyline_cell_type, fmt::join(shape.arc_length, " "));
}

}  // namespace dlo::compare
