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

namespace dlo::compare {
namespace {

constexpr int drawn_samples = 201;
constexpr double plot_width = figure_width - left_margin - right_margin;  // [pixels]
constexpr double highest_plot = 460;                                      // [pixels]
constexpr double flattest_plot = 110;                                     // [pixels]
constexpr int curvature_plot = 280;                                       // height [pixels]
constexpr double same_curve = 1e-6;                                       // of the length
constexpr const char* axis_names = "xyz";

/// One shape of a figure.
struct Series {
  std::string id;     ///< in the CSV
  std::string title;  ///< in the key
  std::string style;  ///< gnuplot's
  Eigen::Matrix3Xd points;
  std::vector<double> arc_length;
  std::vector<double> curvature;  ///< empty: none to show; NaN at the ends of polygons
};

/// Which axes a plot has, to the right and up.
struct View {
  int right = 0;
  int up = 1;
};

/// The plane itself if it is a coordinate plane; else two projections that share an axis, the first
/// with gravity upright.
std::vector<View> views_of(const Scene& scene, const Eigen::Matrix3Xd& points) {
  Eigen::Index gravity = 1;
  if (scene.gravity.norm() > 0) scene.gravity.cwiseAbs().maxCoeff(&gravity);
  const int up = static_cast<int>(gravity);
  if (const auto normal = scene.plane_normal()) {
    Eigen::Index along = 0;
    const double largest = normal->cwiseAbs().maxCoeff(&along);
    if (largest > 1 - 1e-12) {
      const int across = static_cast<int>(along);
      if (across != up) return {{3 - across - up, up}};
      return {across == 0 ? View{1, 2} : View{0, 3 - across}};
    }
  }
  std::array<int, 2> others = {(up + 1) % 3, (up + 2) % 3};
  const Eigen::Vector3d extents =
      points.rowwise().maxCoeff() - Eigen::Vector3d(points.rowwise().minCoeff());
  if (extents[others[1]] > extents[others[0]]) std::swap(others[0], others[1]);
  return {{others[0], up}, {others[0], others[1]}};
}

/// Sense of turning, where there is one: the plane's normal.
double signed_curvature(const std::optional<Eigen::Vector3d>& normal,
                        const Eigen::Vector3d& binormal) {
  return normal ? binormal.dot(*normal) : binormal.norm();
}

/// The plane's normal towards the reader of a plot: positive curvature turns to the left.
std::optional<Eigen::Vector3d> normal_to_reader(const Scene& scene, const View& view) {
  std::optional<Eigen::Vector3d> normal = scene.plane_normal();
  if (!normal) return normal;
  const Eigen::Vector3d reader =
      Eigen::Vector3d::Unit(view.right).cross(Eigen::Vector3d::Unit(view.up));
  if (normal->dot(reader) < 0) normal = -*normal;
  return normal;
}

Series reference_series(const Comparison& comparison, const Scene& scene, const View& view) {
  Series series{.id = "energy",
                .title = "energy model (the rod itself)",
                .style = "with lines linecolor rgb 'black' linewidth 2 dashtype 1"};
  series.arc_length = equal_arc_lengths(scene.length, drawn_samples);
  const energy_model::Samples samples = comparison.reference_rod(series.arc_length);
  series.points = samples.points;
  const std::optional<Eigen::Vector3d> normal = normal_to_reader(scene, view);
  for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
    const Eigen::Vector3d tangent = samples.tangents.col(i);
    series.curvature.push_back(
        signed_curvature(normal, tangent.cross(Eigen::Vector3d(samples.curvature.col(i)))));
  }
  return series;
}

/// Turning angle of each inner point over its joint's length.
std::vector<double> polygon_curvature(const Shape& shape, const Scene& scene, const View& view) {
  const std::optional<Eigen::Vector3d> normal = normal_to_reader(scene, view);
  std::vector<double> curvature(shape.arc_length.size(), NAN);
  for (std::size_t i = 1; i + 1 < curvature.size(); ++i) {
    curvature[i] = signed_curvature(normal, joint_curvature(shape, i));
  }
  return curvature;
}

std::vector<Series> series_of(const SceneReport& report, const View& view) {
  const Scene& scene = report.file.scene;
  const std::vector<Comparison>& comparisons = report.comparisons;
  std::vector<Series> all = {reference_series(comparisons.front(), scene, view)};
  if (comparisons.size() > 1) {
    Series other = reference_series(comparisons.back(), scene, view);
    if ((other.points - all.front().points).colwise().norm().maxCoeff() >
        same_curve * scene.length) {
      other.id = "energy_of_hooke";
      other.title = "energy model, the state that law hooke is in";
      other.style = "with lines linecolor rgb '#606060' linewidth 2 dashtype 4";
      all.push_back(other);
    }
  }
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const Comparison& c = comparisons[i];
    all.push_back({.id = i == 0 ? "force" : "force_hooke_consistent",
                   .title = setting_name(c.settings),
                   .style = i == 0 ? "with linespoints linecolor rgb '#B34700' dashtype 2 "
                                     "pointtype 5 pointsize 0.6"
                                   : "with linespoints linecolor rgb '#0059A8' dashtype 3 "
                                     "pointtype 6 pointsize 0.9",
                   .points = c.force.shape.points,
                   .arc_length = c.force.shape.arc_length,
                   .curvature = polygon_curvature(c.force.shape, scene, view)});
  }
  if (const auto straight = straight_rod(scene, {0, scene.length})) {
    all.push_back({.id = "unbent",
                   .title = "the unbent rod",
                   .style = "with lines linecolor rgb '#808080' linewidth 1 dashtype 4",
                   .points = *straight,
                   .arc_length = {0, scene.length}});
  }
  Series grips{.id = "gripper",
               .title = scene.grippers.size() == 1 ? "gripper" : "grippers",
               .style = "with points linecolor rgb 'black' pointtype 2 pointsize 1.2"};
  grips.points.resize(3, static_cast<Eigen::Index>(scene.grippers.size()));
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    grips.points.col(static_cast<Eigen::Index>(i)) = scene.grippers[i].position;
    grips.arc_length.push_back(scene.grippers[i].at);
  }
  all.push_back(grips);
  return all;
}

std::string scene_csv(const std::vector<Series>& all) {
  std::string csv = "series,s_m,x_m,y_m,z_m,curvature_per_m\n";
  for (const Series& series : all) {
    for (std::size_t i = 0; i < series.arc_length.size(); ++i) {
      const Eigen::Vector3d point = series.points.col(static_cast<Eigen::Index>(i));
      csv += fmt::format("{},{},{},{},{},{}\n", series.id, csv_number(series.arc_length[i]),
                         csv_number(point.x()), csv_number(point.y()), csv_number(point.z()),
                         series.curvature.empty() ? "" : csv_number(series.curvature[i]));
    }
  }
  return csv;
}

/// Least and largest coordinate of all series.
std::array<double, 2> range_of(const std::vector<Series>& all, int axis) {
  std::array<double, 2> range = {HUGE_VAL, -HUGE_VAL};
  for (const Series& series : all) {
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

std::string plot_lines(const std::vector<Series>& all, const std::string& csv_file,
                       const std::string& x, const std::string& y, Titles titles) {
  std::string out = "plot";
  std::string separator = " ";
  for (const Series& series : all) {
    fmt::format_to(
        std::back_inserter(out), "{}'{}' using (strcol(1) eq '{}' ? {} : NaN):{} {} {}", separator,
        csv_file, series.id, x, y,
        titles == Titles::shown ? "title " + gnuplot_string(series.title) : std::string("notitle"),
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
  const int rows = static_cast<int>(all.size());
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
                      fmt::format("{}", views[i].up + 3), last ? Titles::shown : Titles::left_out);
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
  return text + ".";
}

}  // namespace

std::vector<Figure> scene_figures(const SceneReport& scene, std::size_t number) {
  if (scene.comparisons.empty()) return {};
  const std::vector<View> views =
      views_of(scene.file.scene, scene.comparisons.front().reference.points);
  const std::vector<Series> all = series_of(scene, views.front());
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
