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

std::string vtk_polyline(const Shape& shape, const std::vector<double>& curvature,
                         const std::vector<double>& tension, const std::string& title) {
  const Eigen::Matrix3Xd& points = shape.points;
  std::string text =
      fmt::format("# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
                  vtk_title(title), points.cols());
  const auto out = std::back_inserter(text);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    fmt::format_to(out, "{:.17g} {:.17g} {:.17g}\n", points(0, i), points(1, i), points(2, i));
  }
  fmt::format_to(out, "LINES 1 {}\n{}", points.cols() + 1, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) fmt::format_to(out, " {}", i);
  std::vector<std::pair<const char*, std::vector<double>>> fields = {
      {"arc_length_m", shape.arc_length}, {"curvature_per_m", curvature}};
  if (!tension.empty()) fields.emplace_back("tension_N", tension);
  fmt::format_to(out, "\nPOINT_DATA {}\nFIELD rod {}\n", points.cols(), fields.size());
  for (const auto& [name, values] : fields) {
    fmt::format_to(out, "{} 1 {} double\n{:.17g}\n", name, values.size(), fmt::join(values, "\n"));
  }
  return text;
}

}  // namespace dlo::compare
