#include "picture/map_figure.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "base/quote.hpp"
#include "polygon/step_constants.hpp"

namespace dlo::compare {

Figure map_figure(const StabilityMap& map) {
  Figure figure{
      .name = "stability_map",
      .section = "stability",
      .title = map.scene + ": largest stable c_F",
      .description = fmt::format(
          "Grid of step factors c_F over {}, each point by what became of the rod: stable, growing "
          "within bounds, or diverged. Lines for the predicted limit, the measured one, and Table "
          "1's proportion.",
          map.axis == MapAxis::c_c ? "stretch stiffnesses c_c, both logarithmic"
                                   : "shares c_h of the last step, c_F logarithmic"),
      .csv_file = "stability_map.csv"};
  figure.csv = "kind,c_c_N,c_h,c_F_m_per_N\n";
  for (const MapPoint& point : map.points) {
    figure.csv += fmt::format("{},{},{},{}\n", to_string(point.outcome), csv_number(point.c_c),
                              csv_number(point.c_h), csv_number(point.c_F));
  }
  const std::pair<const char*, double MapColumn::*> limits[] = {
      {"predicted", &MapColumn::predicted},
      {"measured", &MapColumn::measured},
      {"table_1", &MapColumn::table_1}};
  for (const auto& [kind, limit] : limits) {
    for (const MapColumn& column : map.columns) {
      figure.csv += fmt::format("{},{},{},{}\n", kind, csv_number(column.c_c),
                                csv_number(column.c_h), csv_number(column.*limit));
    }
  }
  struct Curve {
    const char* kind;
    std::string title;
    const char* style;
  };
  const Curve curves[] = {
      {"pass", "stable", "with points linecolor rgb '#0059A8' pointtype 7 pointsize 0.25"},
      {"oscillates", "grows, within bounds",
       "with points linecolor rgb '#8A2F85' pointtype 8 pointsize 0.6"},
      {"diverges", "diverges", "with points linecolor rgb '#B34700' pointtype 2 pointsize 0.7"},
      {"predicted", "predicted limit", "with lines linecolor rgb 'black' dashtype 1 linewidth 2"},
      {"measured", "measured limit",
       "with linespoints linecolor rgb '#00704F' dashtype 2 pointtype 4 pointsize 0.7"},
      {"table_1", fmt::format("Table 1: {}", table_1_step_formula),
       "with lines linecolor rgb '#606060' dashtype 3 linewidth 2"}};
  const bool over_c_c = map.axis == MapAxis::c_c;
  Panel panel{.x_label = over_c_c ? "c_c [N]" : "c_h",
              .y_label = "c_F [m/N]",
              .key_rows = static_cast<int>(std::size(curves))};
  panel.script =
      over_c_c ? "set logscale xy\nset format x '%.0e'\nset xtics 100\n" : "set logscale y\n";
  panel.script += "set format y '%.0e'\nplot";
  std::string separator = " ";
  for (const Curve& curve : curves) {
    panel.script +=
        fmt::format("{}'{}' using (strcol(1) eq '{}' ? ${} : NaN):4 title '{}' {}", separator,
                    figure.csv_file, curve.kind, over_c_c ? 2 : 3, curve.title, curve.style);
    separator = ", \\\n  ";
  }
  panel.script += "\n";
  figure.panels = {panel};
  return figure;
}

}  // namespace dlo::compare
