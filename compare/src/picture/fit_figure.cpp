#include "picture/fit_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/quote.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::compare {
namespace {

Figure shape_figure(const Scene& scene, const FittedShape& shape, std::size_t number) {
  const std::vector<View> views = views_of(scene, shape.rod.points);
  std::vector<Series> all = obstacle_series(scene, views, shape.rod.points);
  all.push_back({.id = "rod",
                 .title = "the fitted rod",
                 .style = "with lines linecolor rgb 'black' linewidth 2 dashtype 1",
                 .points = shape.rod.points,
                 .arc_length = shape.rod.arc_length});
  all.push_back({.id = "file",
                 .title = fmt::format("points of shape {}, RMS {:.4g} mm", number,
                                      shape.alignment.rms_m * 1e3),
                 .style = "with points linecolor rgb '#B34700' pointtype 7 pointsize 0.6",
                 .points = shape.alignment.shape.points,
                 .arc_length = shape.alignment.shape.arc_length});
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  Figure figure{.name = fmt::format("shape_{}", number),
                .title = shape.scene,
                .csv_file = fmt::format("shape_{}.csv", number),
                .csv = series_csv(all)};
  figure.panels = shape_panels(figure.csv_file, all, views);
  return figure;
}

Figure profile_figure(const NamedValue& stiffness, const MaterialFit& fit) {
  Figure figure{.name = "profile",
                .title = fmt::format("Profile likelihood of {}", stiffness.name),
                .csv_file = "profile.csv",
                .csv = "stiffness,excess_over_limit\n"};
  for (const ProfilePoint& point : fit.profile) {
    fmt::format_to(std::back_inserter(figure.csv), "{},{}\n", csv_number(point.stiffness),
                   csv_number(point.excess_over_limit));
  }
  Panel panel{.height = 300,
              .x_label = fmt::format("{} [{}]", stiffness.name, stiffness.unit),
              .y_label = "excess of squares over that at the 95 % limit",
              .key_rows = 3};
  const double from = fit.profile.front().stiffness;
  const double to = fit.profile.back().stiffness;
  panel.script = fmt::format(
      "set xrange [{:.10g}:{:.10g}]\nset yrange [0:4]\nset xtics {:g}\nset format x '%.3g'\n", from,
      to, tic_step(2.5 * (to - from)));  // numbers as wide as a fifth of the plot
  const FittedValue& value = fit.youngs_modulus;
  // Behind the curve: the interval, open sides to the plot's edge.
  const auto edge = [](const std::optional<double>& end, const char* open) {
    return end ? fmt::format("first {:.10g}", *end) : std::string("graph ") + open;
  };
  fmt::format_to(std::back_inserter(panel.script),
                 "set object 1 rectangle from {}, graph 0 to {}, graph 1 behind fillcolor rgb "
                 "'#DCE9F5' fillstyle solid noborder\n",
                 edge(value.low, "0"), edge(value.high, "1"));
  const std::string interval = fmt::format(
      "95 % interval: {} to {} {}", value.low ? fmt::format("{:.4g}", *value.low) : "open",
      value.high ? fmt::format("{:.4g}", *value.high) : "open", stiffness.unit);
  fmt::format_to(std::back_inserter(panel.script),
                 "plot '{}' skip 1 using 1:2 title 'profile' with lines linecolor rgb 'black' "
                 "linewidth 2, \\\n  1 title 'limit of the interval' with lines linecolor rgb "
                 "'#A00000' dashtype 2, \\\n  NaN title {} with boxes fillstyle solid noborder "
                 "linecolor rgb '#B5CFE8'",
                 figure.csv_file, gnuplot_string(interval));
  if (value.value) {
    ++panel.key_rows;
    fmt::format_to(std::back_inserter(panel.script),
                   ", \\\n  '+' using ($0 == 0 ? {:.10g} : NaN):(0) title '{} = {:.4g} {}' with "
                   "points linecolor rgb '#0059A8' pointtype 7 pointsize 1",
                   *value.value, stiffness.name, *value.value, stiffness.unit);
  }
  panel.script += "\n";
  figure.panels = {panel};
  return figure;
}

}  // namespace

Picture fit_picture(const std::vector<Scene>& scenes, const MaterialFit& fit) {
  constexpr std::size_t across = 3;
  Picture picture;
  PictureRow row;
  if (!fit.profile.empty()) {
    row.push_back({profile_figure(scenes.front().stiffness(), fit)});
  }
  for (std::size_t i = 0; i < fit.shapes.size(); ++i) {
    if (row.size() == across) {
      picture.rows.push_back(std::move(row));
      row.clear();
    }
    row.push_back({shape_figure(scenes[i], fit.shapes[i], i + 1)});
  }
  picture.rows.push_back(std::move(row));
  return picture;
}

}  // namespace dlo::compare
