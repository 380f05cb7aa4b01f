#include "figure/shape_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace dlo::compare {
namespace {

constexpr double highest_plot = 460;   // [pixels]
constexpr double flattest_plot = 110;  // [pixels]
constexpr int curvature_plot = 280;    // height [pixels]

/// Least and largest coordinate of all series.
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

/// Widened about its middle.
std::array<double, 2> widened(const std::array<double, 2>& range, double to) {
  const double middle = (range[0] + range[1]) / 2;
  const double half = std::max(extent(range), to) / 2;
  return {middle - half, middle + half};
}

/// Width of a number on an axis, of letters 16 pixels high [pixels].
double label_width(const std::string& number) {
  constexpr double digit = 10.2;
  constexpr double mark = 5.8;  // a point or a minus
  double width = 0;
  for (const char c : number) width += c == '.' || c == '-' ? mark : digit;
  return width;
}

/// tic_step(), or a longer one whose numbers do not run into each other below the axis.
double level_tic_step(const std::array<double, 2>& range, double pixels_per_metre) {
  constexpr double gap = 8;  // [pixels]
  double step = 0;
  for (const double factor : {1.0, 2.0, 4.0}) {
    step = tic_step(extent(range) * factor);
    double widest = 0;
    for (double k = std::ceil(range[0] / step); k * step <= range[1]; ++k) {
      widest = std::max(widest, label_width(fmt::format("{:.6g}", k * step)));
    }
    if (widest + gap <= step * pixels_per_metre) break;
  }
  return step;
}

enum class Titles { shown, hidden };

bool is_shown(const Series& series, int view) { return series.view < 0 || series.view == view; }

int rows_of_key(const std::vector<Series>& all, int view) {
  return static_cast<int>(std::count_if(all.begin(), all.end(), [view](const Series& series) {
    return is_shown(series, view) && !series.title.empty();
  }));
}

std::string plot_lines(const std::vector<Series>& all, const std::string& csv_file,
                       const std::string& x, const std::string& y, Titles titles, int view = 0) {
  std::string out = "plot";
  std::string separator = " ";
  for (const Series& series : all) {
    if (!is_shown(series, view)) continue;
    const bool shown = titles == Titles::shown && !series.title.empty();
    fmt::format_to(
        std::back_inserter(out), "{}{} {} {}", separator, series_data(csv_file, series.id, x, y),
        shown ? "title " + gnuplot_string(series.title) : std::string("notitle"), series.style);
    separator = ", \\\n  ";
  }
  return out + "\n";
}

}  // namespace

double tic_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range)));
  const double leading = range / power;
  return power * (leading >= 5 ? 1 : leading >= 2 ? 0.5 : 0.2);
}

std::string series_data(const std::string& csv_file, const std::string& id, const std::string& x,
                        const std::string& y) {
  return fmt::format("'{}' using (strcol(1) eq '{}' ? {} : NaN):{}", csv_file, id, x, y);
}

std::vector<Panel> shape_panels(const std::string& csv_file, const std::vector<Series>& all,
                                const std::vector<View>& views) {
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
    const bool last = i + 1 == views.size();
    const std::array<double, 2> own = range_of(all, view.up);
    // Whole pixels: the range is what fits them.
    const int height = static_cast<int>(
        std::ceil(std::max(extent(own) * margin * pixels_per_metre, flattest_plot)));
    const std::array<double, 2> up = widened(own, height / pixels_per_metre);
    Panel panel{.height = height,
                .x_label = fmt::format("{} [m]", axis_names[view.right]),
                .y_label = fmt::format("{} [m]", axis_names[view.up]),
                .key_rows = last ? rows_of_key(all, static_cast<int>(i)) : 0};
    panel.script = fmt::format(
        "# equal aspect: {:.6g} pixels a metre on both axes\n"
        "set xrange [{:.6g}:{:.6g}]\nset xtics {:g}\nset ytics {:g}\nset yrange [{:.6g}:{:.6g}]\n",
        pixels_per_metre, x[0], x[1], level_tic_step(x, pixels_per_metre), tic_step(width), up[0],
        up[1]);
    panel.script += plot_lines(all, csv_file, fmt::format("${}", view.right + 3),
                               fmt::format("{}", view.up + 3),
                               last ? Titles::shown : Titles::hidden, static_cast<int>(i));
    panels.push_back(std::move(panel));
  }
  return panels;
}

Panel curvature_panel(const std::string& csv_file, const std::vector<Series>& all, bool planar) {
  std::vector<Series> shown;
  std::copy_if(all.begin(), all.end(), std::back_inserter(shown),
               [](const Series& series) { return !series.curvature.empty(); });
  return {.height = curvature_plot,
          .x_label = "arc length s [m]",
          .y_label = planar ? "curvature [1/m], > 0: to the left" : "curvature [1/m]",
          .key_rows = static_cast<int>(shown.size()),
          .script = plot_lines(shown, csv_file, "$2", "6", Titles::shown)};
}

}  // namespace dlo::compare
