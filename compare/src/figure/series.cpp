#include "figure/series.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "dlo/obstacle/outline.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

constexpr int curve_samples = 201;

/// Returns the curvature with a sign about the normal, or its magnitude without a normal.
double signed_curvature(const std::optional<Eigen::Vector3d>& normal,
                        const Eigen::Vector3d& binormal) {
  return normal ? binormal.dot(*normal) : binormal.norm();
}

/// Returns the normal of the scene's plane if all points are in it; else std::nullopt.
std::optional<Eigen::Vector3d> plane_through(const Scene& scene, const Eigen::Matrix3Xd& points) {
  constexpr double plane_tolerance = 1e-6;  // in lengths
  std::optional<Eigen::Vector3d> normal = scene.plane_normal();
  if (!normal) return std::nullopt;
  const Eigen::Vector3d grip_position = scene.grippers.front().position;
  for (const auto& point : points.colwise()) {
    if (!(std::abs(normal->dot(point - grip_position)) <= plane_tolerance * scene.length))
      return std::nullopt;
  }
  return normal;
}

/// Returns the plane's normal with the sign that points to the viewer of a plot, so that positive
/// curvature bends to the left; std::nullopt if the points leave the plane.
std::optional<Eigen::Vector3d> normal_towards_viewer(const Scene& scene, const View& view,
                                                     const Eigen::Matrix3Xd& points) {
  std::optional<Eigen::Vector3d> normal = plane_through(scene, points);
  if (!normal) return std::nullopt;
  const Eigen::Vector3d reader =
      Eigen::Vector3d::Unit(view.right).cross(Eigen::Vector3d::Unit(view.up));
  if (normal->dot(reader) < 0) normal = -*normal;
  return normal;
}

/// Clips a convex outline at a limit of one of its coordinates (Sutherland and Hodgman).
Eigen::Matrix3Xd clipped(const Eigen::Matrix3Xd& outline, int axis, double limit, double sign) {
  std::vector<Eigen::Vector3d> kept;
  const Eigen::Index count = outline.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d a = outline.col(i);
    const Eigen::Vector3d b = outline.col((i + 1) % count);
    const double before = sign * (limit - a[axis]);
    const double after = sign * (limit - b[axis]);
    if (before >= 0) kept.push_back(a);
    if ((before >= 0) != (after >= 0)) kept.emplace_back(a + (b - a) * (before / (before - after)));
  }
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = kept[i];
  return result;
}

}  // namespace

Series within(Series outline, const View& view, const std::array<double, 2>& low,
              const std::array<double, 2>& high) {
  const std::array<int, 2> axes = {view.right, view.up};
  for (std::size_t i = 0; i < 2; ++i) {
    outline.points = clipped(outline.points, axes[i], low[i], -1);
    outline.points = clipped(outline.points, axes[i], high[i], 1);
  }
  return outline;
}

Eigen::Matrix3Xd concatenated(const std::vector<const Eigen::Matrix3Xd*>& parts) {
  Eigen::Matrix3Xd all(3, 0);
  for (const Eigen::Matrix3Xd* part : parts) {
    all.conservativeResize(3, all.cols() + part->cols());
    all.rightCols(part->cols()) = *part;
  }
  return all;
}

bool stays_in_plane(const Scene& scene, const Eigen::Matrix3Xd& points) {
  return plane_through(scene, points).has_value();
}

std::vector<View> views_of(const Scene& scene, const Eigen::Matrix3Xd& points) {
  Eigen::Index gravity = 1;
  if (scene.gravity.norm() > 0) scene.gravity.cwiseAbs().maxCoeff(&gravity);
  const int up = static_cast<int>(gravity);
  if (const auto normal = plane_through(scene, points)) {
    Eigen::Index along = 0;
    const double largest = normal->cwiseAbs().maxCoeff(&along);
    if (largest > 1 - 1e-12) {
      const int across = static_cast<int>(along);
      if (across != up) return {{3 - across - up, up}};
      return {across == 0 ? View{1, 2} : View{0, 3 - across}};
    }
  }
  std::array<int, 2> others = {(up + 1) % 3, (up + 2) % 3};
  const Eigen::Vector3d extents =
      points.rowwise().maxCoeff() - Eigen::Vector3d(points.rowwise().minCoeff());
  if (extents[others[1]] > extents[others[0]]) std::swap(others[0], others[1]);
  return {{others[0], up}, {others[0], others[1]}};
}

Series rod_series(const Reference& rod, const Scene& scene, const View& view) {
  Series series{.id = "energy", .title = "energy model (the rod itself)", .look = {.width = 2}};
  series.arc_length = equal_arc_lengths(scene.length, curve_samples);
  const energy_model::Samples samples = rod(series.arc_length);
  series.points = samples.points;
  const std::optional<Eigen::Vector3d> normal = normal_towards_viewer(scene, view, series.points);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
    const Eigen::Vector3d tangent = samples.tangents.col(i);
    series.curvature.push_back(
        signed_curvature(normal, tangent.cross(Eigen::Vector3d(samples.curvature.col(i)))));
  }
  return series;
}

Series polygon_series(const Shape& shape, const Scene& scene, const View& view) {
  Series series{.id = "force", .points = shape.points, .arc_length = shape.arc_length};
  const std::optional<Eigen::Vector3d> normal = normal_towards_viewer(scene, view, series.points);
  series.curvature.assign(shape.arc_length.size(), NAN);
  for (std::size_t i = 1; i + 1 < series.curvature.size(); ++i) {
    series.curvature[i] = signed_curvature(normal, joint_curvature(shape, i));
  }
  return series;
}

std::optional<Series> straight_rod_series(const Scene& scene) {
  const auto straight = straight_rod(scene, {0, scene.length});
  if (!straight) return std::nullopt;
  return Series{.id = "unbent",
                .title = "the unbent rod",
                .look = {.colour = "#808080", .dashes = Dashes::dash_dotted},
                .points = *straight};
}

std::vector<Series> gripper_series(const Scene& scene) {
  constexpr double clamp_stub_length = 0.04;  // in lengths
  std::vector<Series> all;
  Series grips{.id = "gripper",
               .title = scene.grippers.size() == 1 ? "gripper" : "grippers",
               .look = {.width = 0, .mark = Mark::cross, .mark_size = 1.2}};
  grips.points.resize(3, static_cast<Eigen::Index>(scene.grippers.size()));
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    grips.points.col(static_cast<Eigen::Index>(i)) = gripper.position;
    if (!gripper.direction) continue;
    Series clamp{.id = fmt::format("clamp_{}", i + 1), .look = {.colour = "#909090", .width = 6}};
    const Eigen::Vector3d along = clamp_stub_length * scene.length * *gripper.direction;
    clamp.points.resize(3, 2);
    clamp.points << gripper.position - along, gripper.position + along;
    all.push_back(std::move(clamp));
  }
  all.push_back(std::move(grips));
  return all;
}

std::optional<Series> contact_series(const std::vector<energy_model::ContactPart>& contacts,
                                     const RodPoints& rod, double length) {
  constexpr double largest_sample_distance =
      1.0 / 150;  // largest distance of drawn points, in lengths
  Series series{.id = "contact",
                .title = "where the rod itself touches",
                .look = {.colour = "#207A34", .width = 0, .mark = Mark::dot, .mark_size = 0.45}};
  std::vector<double> touched;
  for (const energy_model::ContactPart& contact : contacts) {
    const double lies = contact.end - contact.begin;
    const int steps = static_cast<int>(std::ceil(lies / (largest_sample_distance * length)));
    for (int i = 0; i <= steps; ++i) {
      touched.push_back(contact.begin + (steps > 0 ? lies * i / steps : 0));
    }
  }
  if (touched.empty()) return std::nullopt;
  series.points = rod(touched);
  return series;
}

std::vector<Series> obstacle_series(const Scene& scene, const std::vector<View>& views,
                                    const Eigen::Matrix3Xd& rod) {
  std::vector<Series> all;
  const Eigen::Vector3d middle = rod.rowwise().mean();
  for (std::size_t v = 0; v < views.size(); ++v) {
    bool titled = false;  // only one outline per view has a legend entry
    const Eigen::Vector3d right = Eigen::Vector3d::Unit(views[v].right);
    const Eigen::Vector3d up = Eigen::Vector3d::Unit(views[v].up);
    for (const std::size_t i : obstacles_in_reach(scene, scene.force_model)) {
      const obstacle::Body& body = scene.obstacles[i].body;
      // The outline extends beyond every edge of a plot, which is no larger than the rod's reach.
      const double far = 10 * (scene.length + (body.centre() - middle).norm());
      const Eigen::Matrix2Xd visible = obstacle::outline(body, right, up, far);
      if (visible.cols() == 0) continue;
      Series series{.id = fmt::format("obstacle_{}_{}{}", i + 1, axis_names[views[v].right],
                                      axis_names[views[v].up]),
                    .title = titled ? "" : "obstacles, where the rod's axis cannot be",
                    .look = {.colour = "#8A8A8A", .fill = "#E4E4E4"},
                    .view = static_cast<int>(v)};
      titled = true;
      series.points = right * visible.row(0) + up * visible.row(1);
      series.points += (Eigen::Vector3d::Ones() - right - up).cwiseProduct(body.centre()) *
                       Eigen::RowVectorXd::Ones(visible.cols());
      all.push_back(std::move(series));
    }
  }
  return all;
}

}  // namespace dlo::compare
