#include "picture/comparison_figure.hpp"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "base/quote.hpp"
#include "dlo/compare/deviation.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::compare {
namespace {

constexpr double same_curve = 1e-6;  // of the length

constexpr const char* force_styles[] = {
    "with linespoints linecolor rgb '#B34700' dashtype 2 pointtype 5 pointsize 0.6",
    "with linespoints linecolor rgb '#0059A8' dashtype 3 pointtype 6 pointsize 0.9"};

const char* force_id(std::size_t i) { return i == 0 ? "force" : "force_hooke_consistent"; }

std::vector<Series> series_of(const Scene& scene, const std::vector<Comparison>& comparisons,
                              const std::vector<View>& views) {
  const View& view = views.front();
  const Series rod = rod_series(comparisons.front().reference_rod, scene, view);
  std::vector<Series> all = obstacle_series(scene, views, rod.points);
  all.push_back(rod);
  if (comparisons.size() > 1) {
    Series other = rod_series(comparisons.back().reference_rod, scene, view);
    if ((other.points - rod.points).colwise().norm().maxCoeff() > same_curve * scene.length) {
      other.id = "energy_of_hooke";
      other.title = "energy model, the state that law hooke is in";
      other.style = "with lines linecolor rgb '#606060' linewidth 2 dashtype 4";
      all.push_back(std::move(other));
    }
  }
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    Series force = polygon_series(comparisons[i].force.shape, scene, view);
    force.id = force_id(i);
    force.title = setting_name(comparisons[i].settings);
    force.style = force_styles[i == 0 ? 0 : 1];
    all.push_back(std::move(force));
  }
  if (auto unbent = unbent_series(scene)) all.push_back(std::move(*unbent));
  for (Series& gripper : gripper_series(scene)) all.push_back(std::move(gripper));
  const Comparison& first = comparisons.front();
  const RodPoints points = [&](const std::vector<double>& s) {
    return first.reference_rod(s).points;
  };
  if (auto contact = contact_series(first.contacts, points, scene.length)) {
    all.push_back(std::move(*contact));
  }
  return all;
}

std::string shapes_description(const Scene& scene, const std::vector<Comparison>& comparisons,
                               const std::vector<View>& views) {
  std::string text = fmt::format("Shapes of {} at equal aspect", scene.name);
  text += views.size() > 1 ? ", in two projections:" : ":";
  text += " the energy model as a solid line";
  for (const Comparison& c : comparisons) {
    fmt::format_to(std::back_inserter(text),
                   "; the force model with {}, {:.4g} % of the length "
                   "(RMS) away from it, {:.4g} mm at most",
                   setting_name(c.settings), c.deviation.rms_over_length * 100,
                   c.deviation.max_m * 1e3);
  }
  if (!comparisons.front().contacts.empty()) {
    text += "; obstacles in grey, green where the energy model touches them";
  }
  return text + ".";
}

Figure deviation_figure(const Scene& scene, const std::vector<Comparison>& comparisons,
                        std::size_t number) {
  Figure figure{.name = fmt::format("deviation_{}", number),
                .section = "deviation",
                .title = scene.name + ": deviation along the rod",
                .description =
                    "Distance of the force model's points from the energy model's at equal arc "
                    "length; the largest is circled, the dotted level is the RMS.",
                .csv_file = fmt::format("deviation_{}.csv", number),
                .csv = "series,s_m,distance_m\n"};
  Panel panel{.height = 220, .x_label = "arc length s [m]", .y_label = "distance [mm]"};
  std::string plots;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const Comparison& c = comparisons[i];
    const std::string id = force_id(i);
    const Shape& shape = c.force.shape;
    for (Eigen::Index k = 0; k < shape.points.cols(); ++k) {
      const double s = shape.arc_length[static_cast<std::size_t>(k)];
      fmt::format_to(std::back_inserter(figure.csv), "{},{},{}\n", id, csv_number(s),
                     csv_number((shape.points.col(k) - c.reference.points.col(k)).norm()));
    }
    fmt::format_to(std::back_inserter(figure.csv), "{0}_largest,{1},{2}\n\n", id,
                   csv_number(c.deviation.max_at_m), csv_number(c.deviation.max_m));
    const char* colour = curve_colour(i == 0 ? 1 : 0);
    fmt::format_to(
        std::back_inserter(plots),
        "{0}{1} title {2} {3}, \\\n  {4} notitle with points linecolor rgb '{5}' pointtype 6 "
        "pointsize 1.8 linewidth 2, \\\n  {6:.6g} notitle with lines linecolor rgb '{5}' "
        "dashtype 3",
        i == 0 ? "" : ", \\\n  ", series_data(figure.csv_file, id, "$2", "($3*1e3)"),
        gnuplot_string(setting_name(c.settings)), force_styles[i == 0 ? 0 : 1],
        series_data(figure.csv_file, id + "_largest", "$2", "($3*1e3)"), colour,
        c.deviation.rms_m * 1e3);
    ++panel.key_rows;
  }
  panel.script =
      fmt::format("set xrange [0:{:.6g}]\nset yrange [0:*]\nplot {}\n", scene.length, plots);
  figure.panels = {panel};
  return figure;
}

}  // namespace

std::string setting_name(const ForceModelSettings& settings) {
  return fmt::format("law {}, bookkeeping {}, N = {}", to_string(settings.law),
                     to_string(settings.bookkeeping), settings.points);
}

ComparisonFigures comparison_figures(const Scene& scene, const std::vector<Comparison>& comparisons,
                                     std::size_t number) {
  const std::vector<View> views = views_of(scene, comparisons.front().reference.points);
  const std::vector<Series> all = series_of(scene, comparisons, views);
  ComparisonFigures figures;
  figures.shapes = {.name = fmt::format("shapes_{}", number),
                    .section = "shapes",
                    .title = scene.name + ": shapes",
                    .description = shapes_description(scene, comparisons, views),
                    .csv_file = fmt::format("shapes_{}.csv", number),
                    .csv = series_csv(all)};
  figures.shapes.panels = shape_panels(figures.shapes.csv_file, all, views);
  figures.curvature = {
      .name = fmt::format("curvature_{}", number),
      .section = "shapes",
      .title = scene.name + ": curvature along the rod",
      .description = fmt::format(
          "Curvature of {} against arc length: the energy model's as a solid line, those of the "
          "force model's joints (turning angle over the mean length of both segments) as points.",
          scene.name),
      .csv_file = figures.shapes.csv_file,
      .panels = {curvature_panel(figures.shapes.csv_file, all,
                                 stays_in_plane(scene, comparisons.front().reference.points))}};
  figures.deviation = deviation_figure(scene, comparisons, number);
  return figures;
}

}  // namespace dlo::compare
