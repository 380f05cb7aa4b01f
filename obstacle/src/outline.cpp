#include "dlo/obstacle/outline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dlo::obstacle {
namespace {

constexpr int directions = 120;         // number of points on a full circle
constexpr double edge_rounding = 1e-9;  // components of a unit vector below this are rounding

/// Projected core of a body: its middle and three edges, any of them zero.
struct ProjectedCore {
  Eigen::Vector2d middle;
  Eigen::Matrix<double, 2, 3> axes;
  Eigen::Vector3d lower;
  Eigen::Vector3d upper;

  /// Returns the corner that is farthest in a direction.
  [[nodiscard]] Eigen::Vector2d corner(const Eigen::Vector2d& direction) const {
    Eigen::Vector2d result = middle;
    for (Eigen::Index k = 0; k < 3; ++k) {
      result += (axes.col(k).dot(direction) > 0 ? upper[k] : lower[k]) * axes.col(k);
    }
    return result;
  }
};

ProjectedCore project(const Body& body, const Eigen::Matrix<double, 2, 3>& view, double far) {
  const auto ended = [far](double end) { return std::clamp(end, -far, far); };
  ProjectedCore core{.middle = view * body.centre(),
                     .axes = view * body.axes(),
                     .lower = body.lower().unaryExpr(ended),
                     .upper = body.upper().unaryExpr(ended)};
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (core.axes.col(k).norm() < edge_rounding) core.axes.col(k).setZero();
  }
  return core;
}

/// Returns the angles of the points of a rounded outline, including those normal to its edges.
std::vector<double> angles_of(const ProjectedCore& core) {
  std::vector<double> angles;
  angles.reserve(directions + 6);
  for (int i = 0; i < directions; ++i) {
    angles.push_back((2.0 * i / directions - 1) * std::numbers::pi);
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Vector2d axis = core.axes.col(k);
    if (axis.norm() == 0) continue;
    angles.push_back(std::atan2(axis.x(), -axis.y()));
    angles.push_back(std::atan2(-axis.x(), axis.y()));
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace

Eigen::Matrix2Xd outline(const Body& body, const Eigen::Vector3d& right, const Eigen::Vector3d& up,
                         double far) {
  Eigen::Matrix<double, 2, 3> view;
  view << right.transpose(), up.transpose();
  if (body.is_half_space() && (view * body.normal()).norm() < 1 - edge_rounding) return {};
  const ProjectedCore core = project(body, view, far);
  std::vector<Eigen::Vector2d> points;
  const auto add = [&points](const Eigen::Vector2d& point) {
    if (points.empty() || point != points.back()) points.push_back(point);
  };
  for (const double angle : angles_of(core)) {
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    // The farthest corner changes at the normal of an edge; both corners are ends of the edge.
    constexpr double offset = 1e-7;
    for (const double side : {-offset, offset}) {
      const Eigen::Vector2d near(std::cos(angle + side), std::sin(angle + side));
      add(core.corner(near) + body.radius() * direction);
    }
  }
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  return result;
}

}  // namespace dlo::obstacle
