#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "dlo/compare/deviation.hpp"
#include "figure/series.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

Figure deviation_figure(const Scene& scene, const Comparison& comparison) {
  const Shape& shape = comparison.force.shape;
  const Deviation& deviation = comparison.deviation;
  const std::string colour = curve_style(1).colour;
  PlottedCurve distances{.id = "distance",
                         .title = setting_name(comparison.settings),
                         .look = curve_style(1),
                         .x = shape.arc_length};
  for (Eigen::Index k = 0; k < shape.points.cols(); ++k) {
    distances.y.push_back((shape.points.col(k) - comparison.reference.points.col(k)).norm() * 1e3);
  }
  PlottedCurve largest{
      .id = "largest",
      .look = {.colour = colour, .width = 0, .mark = Mark::circle, .mark_size = 1.8},
      .x = {deviation.max_at_m},
      .y = {deviation.max_m * 1e3}};
  PlottedCurve rms{.look = {.colour = colour, .dashes = Dashes::dotted},
                   .x = {-HUGE_VAL, HUGE_VAL},
                   .y = {deviation.rms_m * 1e3, deviation.rms_m * 1e3}};
  return {.title = scene.name + ": deviation along the rod",
          .panels = {{.height = 220,
                      .x = {.label = "arc length s [m]", .from = 0, .to = scene.length},
                      .y = {.label = "distance [mm]", .from = 0},
                      .curves = {std::move(distances), std::move(largest), std::move(rms)}}}};
}

}  // namespace

std::string setting_name(const ForceModelSettings& settings) {
  return fmt::format("law {}, bookkeeping {}, N = {}", to_string(settings.law),
                     to_string(settings.bookkeeping), settings.points);
}

Drawing comparison_drawing(const Scene& scene, const Comparison& comparison) {
  const std::vector<View> views = views_of(scene, comparison.reference.points);
  const View& view = views.front();
  const Series rod = rod_series(comparison.reference_rod, scene, view);
  std::vector<Series> all = obstacle_series(scene, views, rod.points);
  all.push_back(rod);
  Series force = polygon_series(comparison.force.shape, scene, view);
  force.title = setting_name(comparison.settings);
  force.look = curve_style(1);
  all.push_back(std::move(force));
  if (auto unbent = straight_rod_series(scene)) all.push_back(std::move(*unbent));
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  const RodPoints points = [&](const std::vector<double>& s) {
    return comparison.reference_rod(s).points;
  };
  if (auto contact = contact_series(comparison.contacts, points, scene.length)) {
    all.push_back(std::move(*contact));
  }
  return {views, std::move(all)};
}

ComparisonFigures comparison_figures(const Scene& scene, const Comparison& comparison) {
  const Drawing drawing = comparison_drawing(scene, comparison);
  const bool planar = stays_in_plane(scene, comparison.reference.points);
  return {.shapes = {.title = scene.name + ": shapes", .panels = shape_panels(drawing)},
          .curvature = {.title = scene.name + ": curvature along the rod",
                        .panels = {curvature_panel(drawing.series, planar)}},
          .deviation = deviation_figure(scene, comparison)};
}

}  // namespace dlo::compare
