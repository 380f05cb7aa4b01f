#include "picture/check_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/quote.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::compare {
namespace {

constexpr const char* file_colour = "#B34700";

/// From each point of the rod to the file's.
Series whiskers(const Shape& file, const Shape& rod) {
  Series series{.id = "whisker",
                .title = "distances of the file's points",
                .style = "with lines linecolor rgb '#0059A8' linewidth 1 dashtype 1"};
  const Eigen::Index count = file.points.cols();
  series.points.resize(3, 3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    series.points.col(3 * i) = rod.points.col(i);
    series.points.col(3 * i + 1) = file.points.col(i);
    series.points.col(3 * i + 2).setConstant(NAN);
    const double s = rod.arc_length[static_cast<std::size_t>(i)];
    series.arc_length.insert(series.arc_length.end(), {s, s, s});
  }
  return series;
}

Series worst_point(const ShapeCheck& check) {
  return {.id = "worst",
          .title = fmt::format("worst: point {}, {:.4g} mm", check.worst_point,
                               check.deviation.max_m * 1e3),
          .style = "with points linecolor rgb '#A00000' linewidth 2 pointtype 6 pointsize 1.8",
          .points = check.worst_position,
          .arc_length = {check.deviation.max_at_m}};
}

Figure distance_figure(const Scene& scene, const ShapeCheck& check,
                       std::optional<double> allowed_m) {
  Figure figure{.name = "distance",
                .title = "Distance along the rod",
                .csv_file = "distance.csv",
                .csv = "series,s_m,distance_m\n"};
  const Shape& file = check.alignment.shape;
  for (Eigen::Index i = 0; i < file.points.cols(); ++i) {
    fmt::format_to(std::back_inserter(figure.csv), "distance,{},{}\n",
                   csv_number(check.reference.arc_length[static_cast<std::size_t>(i)]),
                   csv_number((file.points.col(i) - check.reference.points.col(i)).norm()));
  }
  fmt::format_to(std::back_inserter(figure.csv), "worst,{},{}\n",
                 csv_number(check.deviation.max_at_m), csv_number(check.deviation.max_m));
  // A tolerance far above all distances would flatten them: it is then in words only.
  constexpr double far = 5;
  const double largest = check.deviation.max_m;
  const bool level = allowed_m && *allowed_m < far * largest;
  const double top = 1.1 * std::max({largest, level ? *allowed_m : 0, 1e-9 * scene.length});
  Panel panel{.height = 280,
              .x_label = "arc length s [m]",
              .y_label = "distance from the rod [mm]",
              .key_rows = 3};
  panel.script = fmt::format(
      "set xrange [0:{:.6g}]\nset yrange [0:{:.6g}]\nplot {} title "
      "'points of the file' with impulses linecolor rgb '#0059A8' linewidth "
      "1.5",
      scene.length, top * 1e3, series_data(figure.csv_file, "distance", "$2", "($3*1e3)"));
  fmt::format_to(std::back_inserter(panel.script),
                 ", \\\n  {} notitle with points linecolor rgb '{}' pointtype 7 pointsize 0.5"
                 ", \\\n  {} title 'the worst' with points linecolor rgb '#A00000' linewidth 2 "
                 "pointtype 6 pointsize 1.8"
                 ", \\\n  {:.6g} title 'RMS {:.4g} mm' with lines linecolor rgb '#404040' "
                 "dashtype 3 linewidth 1.5",
                 series_data(figure.csv_file, "distance", "$2", "($3*1e3)"), file_colour,
                 series_data(figure.csv_file, "worst", "$2", "($3*1e3)"),
                 check.deviation.rms_m * 1e3, check.deviation.rms_m * 1e3);
  if (allowed_m) {
    ++panel.key_rows;
    fmt::format_to(std::back_inserter(panel.script),
                   ", \\\n  {0:.6g} title 'tolerance {0:.4g} mm' with lines linecolor rgb "
                   "'#A00000' dashtype 2 linewidth 1.5",
                   *allowed_m * 1e3);
  }
  panel.script += "\n";
  figure.panels = {panel};
  return figure;
}

}  // namespace

Picture check_picture(const Scene& scene, const ShapeCheck& check,
                      std::optional<double> allowed_m) {
  const std::vector<View> views = views_of(scene, check.reference.points);
  const Shape& file = check.alignment.shape;
  const Series rod = rod_series(check.rod.sample, scene, views.front());
  std::vector<Series> all = obstacle_series(scene, views, rod.points);
  all.push_back(whiskers(file, check.reference));
  all.push_back(rod);
  all.push_back({.id = "file",
                 .title = "points of the file",
                 .style = fmt::format("with linespoints linecolor rgb '{}' dashtype 2 pointtype 7 "
                                      "pointsize 0.5",
                                      file_colour),
                 .points = file.points,
                 .arc_length = file.arc_length});
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  all.push_back(worst_point(check));
  Figure shapes{
      .name = "shapes", .title = scene.name, .csv_file = "shapes.csv", .csv = series_csv(all)};
  shapes.panels = shape_panels(shapes.csv_file, all, views);
  return {{{{shapes}, {distance_figure(scene, check, allowed_m)}}}};
}

}  // namespace dlo::compare
