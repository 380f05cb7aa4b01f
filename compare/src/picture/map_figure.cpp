#include <fmt/format.h>

#include <string>
#include <utility>

#include "picture/figures.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {

Figure map_figure(const StabilityMap& map) {
  const bool over_c_c = map.axis == MapAxis::c_c;
  Panel panel{.x = {.label = over_c_c ? "c_c [N]" : "c_h", .logarithmic = over_c_c},
              .y = {.label = "c_F [m/N]", .logarithmic = true}};
  const auto add = [&](const auto& at, double c_F, PlottedCurve& curve) {
    curve.x.push_back(over_c_c ? at.c_c : at.c_h);
    curve.y.push_back(c_F);
  };
  std::pair<Outcome, PlottedCurve> outcomes[] = {
      {Outcome::pass,
       {.title = "stable",
        .look = {.colour = "#0059A8", .width = 0, .mark = Mark::dot, .mark_size = 0.25}}},
      {Outcome::oscillates,
       {.title = "grows, within bounds",
        .look = {.colour = "#8A2F85", .width = 0, .mark = Mark::triangle, .mark_size = 0.6}}},
      {Outcome::diverges,
       {.title = "diverges",
        .look = {.colour = "#B34700", .width = 0, .mark = Mark::cross, .mark_size = 0.7}}}};
  for (auto& [outcome, curve] : outcomes) curve.id = to_string(outcome);
  for (const MapPoint& point : map.points) {
    for (auto& [outcome, curve] : outcomes) {
      if (point.outcome == outcome) add(point, point.c_F, curve);
    }
  }
  for (auto& [outcome, curve] : outcomes) panel.curves.push_back(std::move(curve));
  const std::pair<double MapColumn::*, PlottedCurve> limits[] = {
      {&MapColumn::predicted,
       {.id = "predicted", .title = "predicted limit", .look = {.width = 2}}},
      {&MapColumn::measured,
       {.id = "measured",
        .title = "measured limit",
        .look = {.colour = "#00704F",
                 .dashes = Dashes::dashed,
                 .mark = Mark::open_square,
                 .mark_size = 0.7}}},
      {&MapColumn::table_1,
       {.id = "table_1",
        .title = fmt::format("Table 1: {}", table_1_step_formula),
        .look = {.colour = "#606060", .width = 2, .dashes = Dashes::dotted}}}};
  for (auto [limit, curve] : limits) {
    for (const MapColumn& column : map.columns) add(column, column.*limit, curve);
    panel.curves.push_back(std::move(curve));
  }
  return {.title = map.scene + ": largest stable c_F", .panels = {std::move(panel)}};
}

}  // namespace dlo::compare
