#include "shape/write_vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace dlo::compare {
namespace {

/// The format knows printable ASCII and 255 characters in a line.
std::string vtk_title(std::string title) {
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  constexpr std::size_t longest = 200;
  if (title.size() > longest) title.resize(longest);
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

}  // namespace dlo::compare
