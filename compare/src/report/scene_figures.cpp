#include "report/scene_figures.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/quote.hpp"
#include "dlo/compare/deviation.hpp"
#include "report/again.hpp"
#include "report/scene_series.hpp"

namespace dlo::compare {
namespace {

constexpr double plot_width = figure_width - left_margin - right_margin;  // [pixels]
constexpr double highest_plot = 460;                                      // [pixels]
constexpr double flattest_plot = 110;                                     // [pixels]
constexpr int curvature_plot = 280;                                       // height [pixels]

/// Least and largest coordinate of all series.
std::array<double, 2> range_of(const std::vector<Series>& all, int axis) {
  std::array<double, 2> range = {HUGE_VAL, -HUGE_VAL};
  for (const Series& series : all) {
    if (series.view >= 0) continue;
    range[0] = std::min(range[0], series.points.row(axis).minCoeff());
    range[1] = std::max(range[1], series.points.row(axis).maxCoeff());
  }
  return range;
}

double extent(const std::array<double, 2>& range) { return range[1] - range[0]; }

/// Widened about its middle.
std::array<double, 2> widened(const std::array<double, 2>& range, double to) {
  const double middle = (range[0] + range[1]) / 2;
  const double half = std::max(extent(range), to) / 2;
  return {middle - half, middle + half};
}

enum class Titles { shown, left_out };

int rows_of_key(const std::vector<Series>& all) {
  return static_cast<int>(std::count_if(
      all.begin(), all.end(), [](const Series& series) { return !series.title.empty(); }));
}

std::string plot_lines(const std::vector<Series>& all, const std::string& csv_file,
                       const std::string& x, const std::string& y, Titles titles, int view = 0) {
  std::string out = "plot";
  std::string separator = " ";
  for (const Series& series : all) {
    if (series.view >= 0 && series.view != view) continue;
    const bool shown = titles == Titles::shown && !series.title.empty();
    fmt::format_to(std::back_inserter(out), "{}'{}' using (strcol(1) eq '{}' ? {} : NaN):{} {} {}",
                   separator, csv_file, series.id, x, y,
                   shown ? "title " + gnuplot_string(series.title) : std::string("notitle"),
                   series.style);
    separator = ", \\\n  ";
  }
  return out + "\n";
}

/// 1, 2 or 5 times a power of ten, such that five to nine fit into a range.
double tic_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range)));
  const double leading = range / power;
  return power * (leading >= 5 ? 1 : leading >= 2 ? 0.5 : 0.2);
}

/// Equal aspect by construction: both axes have the same number of pixels a metre.
std::string shapes_script(const std::string& name, const std::string& csv_file,
                          const std::vector<Series>& all, const std::vector<View>& views) {
  constexpr double margin = 1.08;
  const std::array<double, 2> right = range_of(all, views.front().right);
  double width = extent(right) * margin;
  for (const View& view : views) {
    width = std::max(width, extent(range_of(all, view.up)) * margin * plot_width / highest_plot);
  }
  const double pixels_per_metre = plot_width / width;
  const std::array<double, 2> x = widened(right, width);
  const int rows = rows_of_key(all);
  std::vector<std::array<double, 2>> ups;
  std::vector<double> heights;
  int height = height_besides_plot(rows);
  for (const View& view : views) {
    const std::array<double, 2> up = range_of(all, view.up);
    ups.push_back(widened(up, std::max(extent(up) * margin, flattest_plot / pixels_per_metre)));
    heights.push_back(extent(ups.back()) * pixels_per_metre);
    height += static_cast<int>(std::ceil(heights.back()));
  }
  const int between = height_besides_plot(0);
  height += between * static_cast<int>(views.size() - 1);
  std::string out = figure_head(name, csv_file, height, rows);
  fmt::format_to(std::back_inserter(out), "# equal aspect: {:.6g} pixels a metre on both axes\n",
                 pixels_per_metre);
  fmt::format_to(std::back_inserter(out),
                 "set xrange [{:.6g}:{:.6g}]\nset xtics {:g}\nset ytics {:g}\n", x[0], x[1],
                 tic_step(width), tic_step(width));
  if (views.size() > 1) out += "set multiplot\n";
  double top = top_margin;  // [pixels]
  for (std::size_t i = 0; i < views.size(); ++i) {
    const bool last = i + 1 == views.size();
    fmt::format_to(std::back_inserter(out),
                   "set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n"
                   "set yrange [{:.6g}:{:.6g}]\n",
                   1 - top / height, 1 - (top + heights[i]) / height, ups[i][0], ups[i][1]);
    out += axis_labels(fmt::format("{} [m]", axis_names[views[i].right]),
                       fmt::format("{} [m]", axis_names[views[i].up]), height, top);
    out += plot_lines(all, csv_file, fmt::format("${}", views[i].right + 3),
                      fmt::format("{}", views[i].up + 3), last ? Titles::shown : Titles::left_out,
                      static_cast<int>(i));
    top += heights[i] + between;
  }
  if (views.size() > 1) out += "unset multiplot\n";
  return out;
}

std::string curvature_script(const std::string& name, const std::string& csv_file,
                             const std::vector<Series>& all, bool planar) {
  std::vector<Series> shown;
  std::copy_if(all.begin(), all.end(), std::back_inserter(shown),
               [](const Series& series) { return !series.curvature.empty(); });
  const int rows = static_cast<int>(shown.size());
  const int height = height_besides_plot(rows) + curvature_plot;
  std::string out = figure_head(name, csv_file, height, rows);
  out += axis_labels("arc length s [m]",
                     planar ? "curvature [1/m], > 0: to the left" : "curvature [1/m]", height,
                     top_margin);
  return out + plot_lines(shown, csv_file, "$2", "6", Titles::shown);
}

std::string shapes_description(const SceneReport& report, const std::vector<View>& views) {
  std::string text = fmt::format("Shapes of {} at equal aspect", report.file.scene.name);
  text += views.size() > 1 ? ", in two projections:" : ":";
  text += " the energy model as a solid line";
  for (const Comparison& c : report.comparisons) {
    fmt::format_to(std::back_inserter(text),
                   "; the force model with {}, {:.4g} % of the length "
                   "(RMS) away from it, {:.4g} mm at most",
                   setting_name(c.settings), c.deviation.rms_over_length * 100,
                   c.deviation.max_m * 1e3);
  }
  const auto& contacts = report.comparisons.front().contacts;
  if (!contacts.empty()) text += "; obstacles in grey, green where the energy model touches them";
  return text + ".";
}

}  // namespace

std::vector<Figure> scene_figures(const SceneReport& scene, std::size_t number) {
  if (scene.comparisons.empty()) return {};
  const std::vector<View> views =
      views_of(scene.file.scene, scene.comparisons.front().reference.points);
  const std::vector<Series> all = series_of(scene, views);
  std::string command = compare_command(scene.file, scene.comparisons.front());
  if (command.empty()) command = "dlo compare scenes/" + scene.file.name;
  Figure shapes{.name = fmt::format("shapes_{}", number),
                .section = "shapes",
                .title = scene.file.scene.name + ": shapes",
                .description = shapes_description(scene, views),
                .command = command + " --format json",
                .given = "distances and points",
                .csv_file = fmt::format("shapes_{}.csv", number),
                .csv = scene_csv(all)};
  shapes.script = shapes_script(shapes.name, shapes.csv_file, all, views);
  Figure curvature{
      .name = fmt::format("curvature_{}", number),
      .section = "shapes",
      .title = scene.file.scene.name + ": curvature along the rod",
      .description = fmt::format(
          "Curvature of {} against arc length: the energy model's as a solid line, those of the "
          "force model's joints (turning angle over the mean length of both segments) as points.",
          scene.file.scene.name),
      .command = command + " --format json",
      .given = "distances and points",
      .csv_file = shapes.csv_file};
  curvature.script =
      curvature_script(curvature.name, curvature.csv_file, all, scene.file.scene.planar());
  return {shapes, curvature};
}

}  // namespace dlo::compare
