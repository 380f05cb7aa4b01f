#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "figure/series.hpp"
#include "picture/figures.hpp"
#include "record/solution_fields.hpp"

namespace dlo::compare {
namespace {

/// Gives magnitudes of curvature the sign of the curvature of the polygon of points, if that has
/// one.
std::vector<double> with_sign_of_polygon(const Solution& solution, const Series& turning) {
  std::vector<double> curvature = solution.curvature;
  const std::size_t count = curvature.size();
  for (std::size_t i = 0; i < count && count > 2; ++i) {
    // The curvature of the polygon is not defined at its ends.
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

CurveStyle solution_style(const Solution& solution, std::size_t i, std::size_t count) {
  const bool polygon = solution.model == Model::chain || solution.model == Model::force;
  const bool stable = is_stable(solution);
  // When colours repeat, dots are added between the dashes.
  const Dashes dashes = i < curve_colours ? Dashes::dashed : Dashes::dash_dotted;
  return {.colour = count == 1 ? CurveStyle().colour : curve_style(i).colour,
          .width = stable ? 2 : 1.5,
          .dashes = stable ? Dashes::solid : dashes,
          .mark = polygon ? Mark::dot : Mark::none,
          .mark_size = 0.5};
}

bool are_planar(const Scene& scene, const std::vector<Solution>& solutions) {
  return std::all_of(solutions.begin(), solutions.end(), [&scene](const Solution& solution) {
    return stays_in_plane(scene, solution.shape.points);
  });
}

}  // namespace

Drawing solution_drawing(const Scene& scene, const std::vector<Solution>& solutions) {
  std::vector<const Eigen::Matrix3Xd*> points;
  points.reserve(solutions.size());
  for (const Solution& solution : solutions) points.push_back(&solution.shape.points);
  const std::vector<View> views = views_of(scene, concatenated(points));
  std::vector<Series> all = obstacle_series(scene, views, *points.front());
  if (auto unbent = straight_rod_series(scene)) all.push_back(std::move(*unbent));
  const bool planar = are_planar(scene, solutions);
  // The stable solutions come first in the list and are drawn on top.
  for (std::size_t k = solutions.size(); k-- > 0;) {
    const Solution& solution = solutions[k];
    Series series = polygon_series(solution.shape, scene, views.front());
    series.id = fmt::format("solution_{}", k + 1);
    series.title = title_of(solution, k + 1, solutions.size());
    series.look = solution_style(solution, k, solutions.size());
    series.curvature = planar ? with_sign_of_polygon(solution, series) : solution.curvature;
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
  return {views, std::move(all)};
}

Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions) {
  const Drawing drawing = solution_drawing(scene, solutions);
  Figure shapes{.title = solutions.size() == 1 ? scene.name : scene.name + ": all equilibria found",
                .panels = shape_panels(drawing)};
  Figure curvature{.title = "Curvature along the rod",
                   .panels = {curvature_panel(drawing.series, are_planar(scene, solutions))}};
  return {{{{shapes}, {curvature}}}};
}

}  // namespace dlo::compare
