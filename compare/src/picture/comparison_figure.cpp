#include "picture/comparison_figure.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <utility>

#include "base/quote.hpp"
#include "dlo/compare/deviation.hpp"
#include "figure/shape_panels.hpp"

namespace dlo::compare {
namespace {

constexpr double same_curve = 1e-6;  // of the length

Look force_look(std::size_t i) { return curve_look(i == 0 ? 1 : 0); }

const char* force_id(std::size_t i) { return i == 0 ? "force" : "force_hooke_consistent"; }

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
  Panel panel{.height = 220,
              .x = {.label = "arc length s [m]", .from = 0, .to = scene.length},
              .y = {.label = "distance [mm]", .from = 0}};
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const Comparison& c = comparisons[i];
    const Shape& shape = c.force.shape;
    PlottedCurve distances{.id = force_id(i),
                           .title = setting_name(c.settings),
                           .look = force_look(i),
                           .x = shape.arc_length};
    for (Eigen::Index k = 0; k < shape.points.cols(); ++k) {
      const double distance = (shape.points.col(k) - c.reference.points.col(k)).norm();
      distances.y.push_back(distance * 1e3);
      fmt::format_to(std::back_inserter(figure.csv), "{},{},{}\n", distances.id,
                     csv_number(shape.arc_length[static_cast<std::size_t>(k)]),
                     csv_number(distance));
    }
    fmt::format_to(std::back_inserter(figure.csv), "{0}_largest,{1},{2}\n\n", distances.id,
                   csv_number(c.deviation.max_at_m), csv_number(c.deviation.max_m));
    const std::string& colour = distances.look.colour;
    PlottedCurve largest{
        .look = {.colour = colour, .width = 0, .mark = Mark::circle, .mark_size = 1.8},
        .x = {c.deviation.max_at_m},
        .y = {c.deviation.max_m * 1e3}};
    PlottedCurve rms{.look = {.colour = colour, .dashes = Dashes::dotted},
                     .x = {-HUGE_VAL, HUGE_VAL},
                     .y = {c.deviation.rms_m * 1e3, c.deviation.rms_m * 1e3}};
    for (PlottedCurve* curve : {&distances, &largest, &rms})
      panel.curves.push_back(std::move(*curve));
  }
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

std::string setting_name(const ForceModelSettings& settings) {
  return fmt::format("law {}, bookkeeping {}, N = {}", to_string(settings.law),
                     to_string(settings.bookkeeping), settings.points);
}

Drawing comparison_drawing(const Scene& scene, const std::vector<Comparison>& comparisons) {
  const std::vector<View> views = views_of(scene, comparisons.front().reference.points);
  const View& view = views.front();
  const Series rod = rod_series(comparisons.front().reference_rod, scene, view);
  std::vector<Series> all = obstacle_series(scene, views, rod.points);
  all.push_back(rod);
  if (comparisons.size() > 1) {
    Series other = rod_series(comparisons.back().reference_rod, scene, view);
    if ((other.points - rod.points).colwise().norm().maxCoeff() > same_curve * scene.length) {
      other.id = "energy_of_hooke";
      other.title = "energy model, the state that law hooke is in";
      other.look = {.colour = "#606060", .width = 2, .dashes = Dashes::dash_dotted};
      all.push_back(std::move(other));
    }
  }
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    Series force = polygon_series(comparisons[i].force.shape, scene, view);
    force.id = force_id(i);
    force.title = setting_name(comparisons[i].settings);
    force.look = force_look(i);
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
  return {views, std::move(all)};
}

ComparisonFigures comparison_figures(const Scene& scene, const std::vector<Comparison>& comparisons,
                                     std::size_t number) {
  const Drawing drawing = comparison_drawing(scene, comparisons);
  ComparisonFigures figures;
  figures.shapes = {.name = fmt::format("shapes_{}", number),
                    .section = "shapes",
                    .title = scene.name + ": shapes",
                    .description = shapes_description(scene, comparisons, drawing.views),
                    .csv_file = fmt::format("shapes_{}.csv", number),
                    .csv = series_csv(drawing.series)};
  figures.shapes.panels = shape_panels(drawing);
  figures.curvature = {
      .name = fmt::format("curvature_{}", number),
      .section = "shapes",
      .title = scene.name + ": curvature along the rod",
      .description = fmt::format(
          "Curvature of {} against arc length: the energy model's as a solid line, those of the "
          "force model's joints (turning angle over the mean length of both segments) as points.",
          scene.name),
      .csv_file = figures.shapes.csv_file,
      .panels = {curvature_panel(drawing.series,
                                 stays_in_plane(scene, comparisons.front().reference.points))}};
  figures.deviation = deviation_figure(scene, comparisons, number);
  return figures;
}

}  // namespace dlo::compare
