#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "figure/series.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

constexpr const char* file_colour = "#B34700";
constexpr const char* blue = "#0059A8";
constexpr const char* red = "#A00000";

Series worst_point(const ShapeCheck& check) {
  return {.id = "worst",
          .title = fmt::format("worst: point {}, {:.4g} mm", check.worst_point,
                               check.deviation.max_m * 1e3),
          .look = worst_point_style(),
          .points = check.worst_position};
}

Figure distance_figure(const Scene& scene, const ShapeCheck& check,
                       std::optional<double> allowed_m) {
  const Shape& file = check.alignment.shape;
  PlottedCurve impulses{
      .id = "distance", .title = "points of the file", .look = {.colour = blue, .width = 1.5}};
  PlottedCurve points{
      .look = {.colour = file_colour, .width = 0, .mark = Mark::dot, .mark_size = 0.5}};
  for (Eigen::Index i = 0; i < file.points.cols(); ++i) {
    const double s = check.reference.arc_length[static_cast<std::size_t>(i)];
    const double mm = (file.points.col(i) - check.reference.points.col(i)).norm() * 1e3;
    impulses.x.insert(impulses.x.end(), {s, s, NAN});
    impulses.y.insert(impulses.y.end(), {0, mm, NAN});
    points.x.push_back(s);
    points.y.push_back(mm);
  }
  Panel panel{.height = 280,
              .x = {.label = "arc length s [m]", .from = 0, .to = scene.length},
              .y = {.label = "distance from the rod [mm]"}};
  panel.curves = {std::move(impulses),
                  std::move(points),
                  {.title = "the worst",
                   .look = worst_point_style(),
                   .x = {check.deviation.max_at_m},
                   .y = {check.deviation.max_m * 1e3}}};
  add_levels(panel, check.deviation.rms_m, allowed_m, check.deviation.max_m, scene.length);
  return {.title = "Distance along the rod", .panels = {std::move(panel)}};
}

}  // namespace

CurveStyle worst_point_style() {
  return {.colour = red, .width = 0, .mark = Mark::circle, .mark_size = 1.8};
}

Series distance_series(const Shape& file, const Shape& rod) {
  Series series{
      .id = "whisker", .title = "distances of the file's points", .look = {.colour = blue}};
  const Eigen::Index count = file.points.cols();
  series.points.resize(3, 3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    series.points.col(3 * i) = rod.points.col(i);
    series.points.col(3 * i + 1) = file.points.col(i);
    series.points.col(3 * i + 2).setConstant(NAN);
  }
  return series;
}

Series file_series(const Shape& file) {
  return {.id = "file",
          .title = "points of the file",
          .look = {.colour = file_colour,
                   .dashes = Dashes::dashed,
                   .mark = Mark::dot,
                   .mark_size = 0.5},
          .points = file.points};
}

void add_levels(Panel& panel, double rms_m, std::optional<double> allowed_m, double largest_m,
                double length) {
  const auto level = [&](double m, const char* what, const CurveStyle& look) {
    panel.curves.push_back({.title = fmt::format("{} {:.4g} mm", what, m * 1e3),
                            .look = look,
                            .x = {-HUGE_VAL, HUGE_VAL},
                            .y = {m * 1e3, m * 1e3}});
  };
  constexpr double largest_limit_ratio = 5;
  constexpr double axis_margin_factor = 1.1;
  const bool has_room = allowed_m && *allowed_m < largest_limit_ratio * largest_m;
  panel.y.from = 0;
  panel.y.to =
      axis_margin_factor * std::max({largest_m, has_room ? *allowed_m : 0, 1e-9 * length}) * 1e3;
  level(rms_m, "RMS", {.colour = "#404040", .width = 1.5, .dashes = Dashes::dotted});
  if (allowed_m) {
    level(*allowed_m, "tolerance", {.colour = red, .width = 1.5, .dashes = Dashes::dashed});
  }
}

Drawing check_drawing(const Scene& scene, const ShapeCheck& check) {
  const std::vector<View> views = views_of(scene, check.reference.points);
  const Shape& file = check.alignment.shape;
  const Series rod = rod_series(check.rod.sample, scene, views.front());
  std::vector<Series> all = obstacle_series(scene, views, rod.points);
  all.push_back(distance_series(file, check.reference));
  all.push_back(rod);
  all.push_back(file_series(file));
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  all.push_back(worst_point(check));
  return {views, std::move(all)};
}

Picture check_picture(const Scene& scene, const ShapeCheck& check,
                      std::optional<double> allowed_m) {
  Figure shapes{.title = scene.name, .panels = shape_panels(check_drawing(scene, check))};
  return {{{{shapes}, {distance_figure(scene, check, allowed_m)}}}};
}

}  // namespace dlo::compare
