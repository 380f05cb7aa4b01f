#include "picture/solution_figure.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "figure/series.hpp"
#include "figure/shape_panels.hpp"
#include "record/solution_fields.hpp"

namespace dlo::compare {
namespace {

/// Amounts of curvature with the sense of turning that the points have, where there is one.
std::vector<double> signed_as_points(const Solution& solution, const Series& turning) {
  std::vector<double> curvature = solution.curvature;
  const std::size_t count = curvature.size();
  for (std::size_t i = 0; i < count && count > 2; ++i) {
    // An end has no turning of its own.
    const std::size_t inner = std::clamp<std::size_t>(i, 1, count - 2);
    if (turning.curvature[inner] < 0) curvature[i] = -curvature[i];
  }
  return curvature;
}

std::string title_of(const Solution& solution, std::size_t number, std::size_t count) {
  if (count == 1) return fmt::format("model {}", to_string(solution.model));
  return fmt::format("{}: {}, {:.4g} J", number, is_stable(solution) ? "stable" : "unstable",
                     solution.energy.total());
}

std::string style_of(const Solution& solution, std::size_t i, std::size_t count) {
  const bool polygon = solution.model == Model::chain || solution.model == Model::force;
  const char* colour = count == 1 ? "black" : curve_colour(i);
  // Where the colours come again there are dots between the dashes.
  const int dashes = i < curve_colours ? 2 : 4;
  return fmt::format("with {} linecolor rgb '{}' linewidth {} dashtype {}",
                     polygon ? "linespoints pointtype 7 pointsize 0.5" : "lines", colour,
                     is_stable(solution) ? 2 : 1.5, is_stable(solution) ? 1 : dashes);
}

}  // namespace

Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions) {
  const std::vector<View> views = views_of(scene, solutions.front().shape.points);
  std::vector<Series> all = obstacle_series(scene, views, solutions.front().shape.points);
  if (auto unbent = unbent_series(scene)) all.push_back(std::move(*unbent));
  const bool planar = std::all_of(
      solutions.begin(), solutions.end(),
      [&scene](const Solution& solution) { return stays_in_plane(scene, solution.shape.points); });
  // The stable ones, which come first, on top.
  for (std::size_t k = solutions.size(); k-- > 0;) {
    const Solution& solution = solutions[k];
    Series series = polygon_series(solution.shape, scene, views.front());
    series.id = fmt::format("solution_{}", k + 1);
    series.title = title_of(solution, k + 1, solutions.size());
    series.style = style_of(solution, k, solutions.size());
    series.curvature = planar ? signed_as_points(solution, series) : solution.curvature;
    all.push_back(std::move(series));
  }
  for (std::size_t k = 0; k < solutions.size(); ++k) {
    const Shape& shape = solutions[k].shape;
    const RodPoints points = [&](const std::vector<double>& s) {
      return resample(shape, s).points;
    };
    if (auto contact = contact_series(solutions[k].contacts, points, scene.length)) {
      contact->id = fmt::format("contact_{}", k + 1);
      contact->title = k == 0 ? "where it touches" : "";
      all.push_back(std::move(*contact));
    }
  }
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  Figure shapes{.name = "shapes",
                .title = solutions.size() == 1 ? scene.name : scene.name + ": all equilibria found",
                .csv_file = "shapes.csv",
                .csv = series_csv(all)};
  shapes.panels = shape_panels(shapes.csv_file, all, views);
  Figure curvature{
      .name = "curvature", .title = "Curvature along the rod", .csv_file = shapes.csv_file};
  curvature.panels = {curvature_panel(shapes.csv_file, all, planar)};
  return {{{{shapes}, {curvature}}}};
}

}  // namespace dlo::compare
