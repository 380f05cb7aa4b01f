#include "dlo/compare/vtk_polyline.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace dlo::compare {
namespace {

std::vector<double> joint_curvatures(const Eigen::Matrix3Xd& points) {
  std::vector<double> result(static_cast<std::size_t>(points.cols()), 0.0);
  for (Eigen::Index i = 1; i + 1 < points.cols(); ++i) {
    const Eigen::Vector3d a = points.col(i) - points.col(i - 1);
    const Eigen::Vector3d b = points.col(i + 1) - points.col(i);
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    result[static_cast<std::size_t>(i)] = 2 * angle / (a.norm() + b.norm());
  }
  if (result.size() > 2) {
    result.front() = result[1];
    result.back() = result[result.size() - 2];
  }
  return result;
}

/// The format knows printable ASCII and 255 characters in a line.
std::string vtk_title(std::string title) {
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  constexpr std::size_t longest = 200;
  if (title.size() > longest) title.resize(longest);
  return title;
}

}  // namespace

std::string vtk_polyline(const Solution& solution, const std::string& title) {
  const Eigen::Matrix3Xd& points = solution.shape.points;
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
      {"arc_length_m", solution.shape.arc_length},
      {"curvature_per_m",
       solution.curvature.empty() ? joint_curvatures(points) : solution.curvature}};
  if (!solution.tension.empty()) fields.emplace_back("tension_N", solution.tension);
  fmt::format_to(out, "\nPOINT_DATA {}\nFIELD rod {}\n", points.cols(), fields.size());
  for (const auto& [name, values] : fields) {
    fmt::format_to(out, "{} 1 {} double\n{:.17g}\n", name, values.size(), fmt::join(values, "\n"));
  }
  return text;
}

}  // namespace dlo::compare
