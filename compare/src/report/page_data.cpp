#include "report/page_data.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "base/number.hpp"
#include "figure/series.hpp"
#include "picture/comparison_figure.hpp"
#include "record/field.hpp"

namespace dlo::compare {
namespace {

/// Five significant digits: a thousandth of what a screen shows.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return as_number<double>(fmt::format("{:.5g}", value)).value() + 0.0;
}

template <typename Values>
Json numbers(const Values& values) {
  return json_list(values, [&](const double value) -> Json { return number(value); });
}

/// Of a rod of some length [1/m]; what is rounding at an end without moment is none.
Json curvature_json(std::vector<double> curvature, double length) {
  constexpr double none = 1e-7;  // of a radian over the whole length
  for (double& value : curvature) {
    if (std::abs(value) * length < none) value = 0;
  }
  return numbers(curvature);
}

Json vector_json(const Eigen::Vector3d& vector) { return numbers(vector); }

Json curve_json(const Series& series, const char* kind, double length) {
  return {{"name", series.title},
          {"kind", kind},
          {"s", numbers(series.arc_length)},
          {"x", numbers(series.points.row(0))},
          {"y", numbers(series.points.row(1))},
          {"z", numbers(series.points.row(2))},
          {"curvature", curvature_json(series.curvature, length)}};
}

Json scene_json(const SceneReport& report) {
  const Scene& scene = report.file.scene;
  const Comparison& first = report.comparisons.front();
  const std::vector<View> views = views_of(scene, first.reference.points);
  const View& view = views.front();
  const Series rod = rod_series(first.reference_rod, scene, view);
  Json curves = Json::array({curve_json(rod, "rod", scene.length)});
  if (!report.tension.empty()) curves.front()["tension"] = numbers(report.tension);
  for (const Comparison& c : report.comparisons) {
    Series polygon = polygon_series(c.force.shape, scene, view);
    polygon.title = setting_name(c.settings);
    Json curve = curve_json(polygon, "polygon", scene.length);
    curve["distance"] = numbers((polygon.points - c.reference.points).colwise().norm());
    curves.push_back(std::move(curve));
  }
  Json grippers = Json::array();
  for (const Gripper& gripper : scene.grippers) {
    Json held = {{"at", number(gripper.at)}, {"position", vector_json(gripper.position)}};
    if (gripper.direction) held["direction"] = vector_json(*gripper.direction);
    grippers.push_back(std::move(held));
  }
  const bool spatial = views.size() > 1;
  Json outlines = Json::array();
  // An outline belongs to one direction of sight.
  if (!spatial) {
    for (const Series& outline : obstacle_series(scene, views, rod.points)) {
      outlines.push_back({{"x", numbers(outline.points.row(0))},
                          {"y", numbers(outline.points.row(1))},
                          {"z", numbers(outline.points.row(2))}});
    }
  }
  return {{"name", scene.name},
          {"length_m", number(scene.length)},
          {"spatial", spatial},
          {"view", {view.right, view.up}},
          {"curves", std::move(curves)},
          {"grippers", std::move(grippers)},
          {"outlines", std::move(outlines)}};
}

/// Whole ten thousandths.
template <typename Values>
Json grid_row(const Values& values) {
  return json_list(values, [&](const double value) -> Json { return std::lround(value * 1e4); });
}

Json grid_points(const Eigen::Matrix2Xd& points) {
  return {{"x", grid_row(points.row(0))}, {"y", grid_row(points.row(1))}};
}

Json grid_json(const ShapeGrid& grid) {
  Json models = json_list(grid.models, [&](const GridModel& model) -> Json {
    return {{"law", to_string(model.law)}, {"bookkeeping", to_string(model.bookkeeping)}};
  });
  Json cells = Json::array();
  for (const GridCell& cell : grid.cells) {
    if (!cell.failure.empty()) {
      cells.push_back({{"failure", cell.failure}});
      continue;
    }
    cells.push_back({{"rod", grid_points(cell.rod)},
                     {"polygon", grid_points(cell.polygon)},
                     {"s", grid_row(cell.s)},
                     {"distance", grid_row(cell.distance)},
                     {"rms", number(cell.rms_over_length)},
                     {"max", number(cell.max_over_length)},
                     {"max_at", number(cell.max_at)}});
  }
  return {{"gammas", grid.options.gammas},
          {"angles_deg", grid.options.angles_deg},
          {"points", grid.options.points},
          {"models", std::move(models)},
          {"cells", std::move(cells)}};
}

}  // namespace

std::string page_data(const Report& report) {
  Json scenes = Json::array();
  for (const SceneReport& scene : report.scenes) {
    if (!scene.comparisons.empty()) scenes.push_back(scene_json(scene));
  }
  const Json document = {{"scenes", std::move(scenes)},
                         {"grid", report.grid ? grid_json(*report.grid) : Json(nullptr)}};
  std::string text;
  for (const char c : document.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";  // ends no script element
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace dlo::compare
