#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "figure/series.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

Figure shape_figure(const Scene& scene, const FittedShape& shape, std::size_t number) {
  const std::vector<View> views = views_of(scene, shape.rod.points);
  std::vector<Series> all = obstacle_series(scene, views, shape.rod.points);
  all.push_back(
      {.id = "rod", .title = "the fitted rod", .look = {.width = 2}, .points = shape.rod.points});
  all.push_back({.id = "file",
                 .title = fmt::format("points of shape {}, RMS {:.4g} mm", number,
                                      shape.alignment.rms_m * 1e3),
                 .look = {.colour = "#B34700", .width = 0, .mark = Mark::dot, .mark_size = 0.6},
                 .points = shape.alignment.shape.points});
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  return {.title = shape.scene, .panels = shape_panels({views, std::move(all)})};
}

Figure profile_figure(const NamedValue& stiffness, const MaterialFit& fit) {
  const FittedValue& value = fit.youngs_modulus;
  // An open side of the interval extends to the plot's edge.
  const double low = value.low.value_or(-HUGE_VAL);
  const double high = value.high.value_or(HUGE_VAL);
  PlottedCurve interval{
      .title =
          fmt::format("95 % interval: {} to {} {}", value.low ? fmt::format("{:.4g}", low) : "open",
                      value.high ? fmt::format("{:.4g}", high) : "open", stiffness.unit),
      .look = {.width = 0, .fill = "#DCE9F5"},
      .x = {low, high, high, low},
      .y = {-HUGE_VAL, -HUGE_VAL, HUGE_VAL, HUGE_VAL}};
  PlottedCurve profile{.id = "profile", .title = "profile", .look = {.width = 2}};
  for (const ProfilePoint& point : fit.profile) {
    profile.x.push_back(point.stiffness);
    profile.y.push_back(point.excess_over_limit);
  }
  constexpr double largest_plotted_excess =
      4;  // in units of the excess at the ends of the interval
  Panel panel{.height = 300,
              .x = {.label = fmt::format("{} [{}]", stiffness.name, stiffness.unit),
                    .from = profile.x.front(),
                    .to = profile.x.back()},
              .y = {.label = "excess of squares over that at the 95 % limit",
                    .from = 0,
                    .to = largest_plotted_excess}};
  panel.curves = {std::move(interval),
                  std::move(profile),
                  {.title = "limit of the interval",
                   .look = {.colour = "#A00000", .dashes = Dashes::dashed},
                   .x = {-HUGE_VAL, HUGE_VAL},
                   .y = {1, 1}}};
  if (value.value) {
    panel.curves.push_back(
        {.title = fmt::format("{} = {:.4g} {}", stiffness.name, *value.value, stiffness.unit),
         .look = {.colour = "#0059A8", .width = 0, .mark = Mark::dot},
         .x = {*value.value},
         .y = {0}});
  }
  return {.title = fmt::format("Profile likelihood of {}", stiffness.name),
          .panels = {std::move(panel)}};
}

}  // namespace

Picture fit_picture(const std::vector<Scene>& scenes, const MaterialFit& fit) {
  constexpr std::size_t items_per_row = 3;
  Picture picture;
  PictureRow row;
  if (!fit.profile.empty()) {
    row.push_back({profile_figure(scenes.front().stiffness(), fit)});
  }
  for (std::size_t i = 0; i < fit.shapes.size(); ++i) {
    if (row.size() == items_per_row) {
      picture.rows.push_back(std::move(row));
      row.clear();
    }
    row.push_back({shape_figure(scenes[i], fit.shapes[i], i + 1)});
  }
  picture.rows.push_back(std::move(row));
  return picture;
}

}  // namespace dlo::compare
