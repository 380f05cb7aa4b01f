#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "figure/series.hpp"

namespace dlo::compare {
namespace {

constexpr double highest_plot = 460;   // [pixels]
constexpr double flattest_plot = 110;  // [pixels]
constexpr int curvature_plot = 280;    // height [pixels]

/// Returns the smallest and the largest coordinate of all series that are shown in all views.
std::array<double, 2> range_of(const std::vector<Series>& all, int axis) {
  std::array<double, 2> range = {HUGE_VAL, -HUGE_VAL};
  for (const Series& series : all) {
    if (series.view >= 0) continue;
    for (Eigen::Index i = 0; i < series.points.cols(); ++i) {
      range[0] = std::fmin(range[0], series.points(axis, i));
      range[1] = std::fmax(range[1], series.points(axis, i));
    }
  }
  return range;
}

double extent(const std::array<double, 2>& range) { return range[1] - range[0]; }

/// Extends a range about its middle to the size `to`, unless it is larger already.
std::array<double, 2> widened(const std::array<double, 2>& range, double to) {
  const double middle = (range[0] + range[1]) / 2;
  const double half = std::max(extent(range), to) / 2;
  return {middle - half, middle + half};
}

std::vector<double> coordinates(const Series& series, int axis) {
  std::vector<double> values(static_cast<std::size_t>(series.points.cols()));
  Eigen::RowVectorXd::Map(values.data(), series.points.cols()) = series.points.row(axis);
  return values;
}

PlotAxis axis_of(int axis, const std::array<double, 2>& limits) {
  return {.label = fmt::format("{} [m]", axis_names[axis]), .from = limits[0], .to = limits[1]};
}

}  // namespace

std::vector<Panel> shape_panels(const Drawing& drawing) {
  const auto& [views, all] = drawing;
  constexpr double margin = 1.08;
  const std::array<double, 2> right = range_of(all, views.front().right);
  double width = extent(right) * margin;
  for (const View& view : views) {
    width = std::max(width, extent(range_of(all, view.up)) * margin * plot_width / highest_plot);
  }
  const double pixels_per_metre = plot_width / width;
  const std::array<double, 2> x = widened(right, width);
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const std::array<double, 2> own = range_of(all, view.up);
    // The height is rounded up to whole pixels, and the range is extended accordingly.
    const int height = static_cast<int>(
        std::ceil(std::max(extent(own) * margin * pixels_per_metre, flattest_plot)));
    const std::array<double, 2> up = widened(own, height / pixels_per_metre);
    Panel panel{.height = height,
                .x = axis_of(view.right, x),
                .y = axis_of(view.up, up),
                .equal_aspect = true,
                .has_legend = i + 1 == views.size()};
    for (const Series& drawn : all) {
      if (drawn.view >= 0 && drawn.view != static_cast<int>(i)) continue;
      const Series series =
          drawn.view < 0 ? drawn : within(drawn, view, {x[0], up[0]}, {x[1], up[1]});
      panel.curves.push_back({.id = series.id,
                              .title = series.title,
                              .look = series.look,
                              .x = coordinates(series, view.right),
                              .y = coordinates(series, view.up)});
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

Panel spatial_panel(const Drawing& drawing) {
  const std::vector<Series>& all = drawing.series;
  // Smallest side over the longest one, so that the tic labels fit.
  constexpr double least_side_ratio = 0.6;
  Panel panel{.upright = drawing.views.front().up, .equal_aspect = true};
  double longest = 0;
  for (const int axis : {0, 1, 2}) longest = std::max(longest, extent(range_of(all, axis)));
  const auto limited = [&](int axis) {
    return axis_of(axis, widened(range_of(all, axis), least_side_ratio * longest));
  };
  panel.x = limited(0);
  panel.y = limited(1);
  panel.z = limited(2);
  for (const Series& series : all) {
    if (series.view >= 0) continue;  // outlines of obstacles belong to one flat view
    panel.curves.push_back({.id = series.id,
                            .title = series.title,
                            .look = series.look,
                            .x = coordinates(series, 0),
                            .y = coordinates(series, 1),
                            .z = coordinates(series, 2)});
  }
  return panel;
}

Panel curvature_panel(const std::vector<Series>& all, bool planar) {
  Panel panel{.height = curvature_plot,
              .x = {.label = "arc length s [m]", .from = 0},
              .y = {.label = planar ? "curvature [1/m], > 0: to the left" : "curvature [1/m]"}};
  double largest = 0;
  for (const Series& series : all) {
    if (series.curvature.empty()) continue;
    for (const double curvature : series.curvature)
      largest = std::fmax(largest, std::abs(curvature));
    panel.x.to = std::max(panel.x.to.value_or(0), series.arc_length.back());
    panel.curves.push_back({.id = series.id,
                            .title = series.title,
                            .look = series.look,
                            .x = series.arc_length,
                            .y = series.curvature});
  }
  constexpr double rounding = 1e-9;  // rounding error of the curvature times the length
  if (largest * panel.x.to.value_or(0) < rounding) {
    panel.y.from = -1;
    panel.y.to = 1;
  }
  return panel;
}

}  // namespace dlo::compare
