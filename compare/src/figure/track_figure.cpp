#include "figure/track_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "base/quote.hpp"
#include "figure/series.hpp"
#include "figure/shape_panels.hpp"
#include "motion/frame_clock.hpp"

namespace dlo::compare {
namespace {

constexpr std::size_t most_shapes = 9;
constexpr double highest_strip = 420;  // [pixels]
constexpr double label_pixels = 20;    // of a cell's time, above its shape
constexpr double air_pixels = 10;      // around its shape
constexpr int most_lines = 6;          // as many as curves have looks

/// Frames equally far apart, the first and the last among them.
std::vector<std::size_t> shown_frames(std::size_t count) {
  const std::size_t shown = std::min(count, most_shapes);
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < shown; ++i) {
    frames.push_back(shown > 1 ? (i * (count - 1) + (shown - 1) / 2) / (shown - 1) : 0);
  }
  return frames;
}

Eigen::Matrix3Xd points_of(const Track& track) {
  const auto samples = static_cast<Eigen::Index>(track.arc_length.size());
  Eigen::Matrix3Xd all(3, samples * static_cast<Eigen::Index>(track.frames.size()));
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    all.middleCols(static_cast<Eigen::Index>(i) * samples, samples) = track.frames[i].points;
  }
  return all;
}

/// Cells of one size, row by row, each with one shape at one scale.
struct Cells {
  std::array<double, 2> least = {0, 0};  ///< coordinates at the lower left corner of a cell [m]
  std::array<double, 2> size = {1, 1};   ///< [m]
  double pixels_per_metre = 1;
  int columns = 1, rows = 1;

  /// What is added to coordinates in a cell [m]: the lowest row begins at 0.
  [[nodiscard]] std::array<double, 2> shift(int cell) const {
    return {cell % columns * size[0] - least[0], (rows - 1 - cell / columns) * size[1] - least[1]};
  }
};

/// As many in a row as lets the shapes be largest.
Cells cells_for(const Eigen::Matrix3Xd& points, const View& view, int count) {
  const std::array<int, 2> axes = {view.right, view.up};
  std::array<double, 2> least{};
  std::array<double, 2> extent{};
  for (std::size_t i = 0; i < 2; ++i) {
    least[i] = points.row(axes[i]).minCoeff();
    extent[i] = points.row(axes[i]).maxCoeff() - least[i];
  }
  const double largest = std::max(extent[0], extent[1]);
  for (std::size_t i = 0; i < 2; ++i) {  // a straight rod has room too
    const double wanted = std::max(extent[i], 0.2 * largest);
    least[i] -= (wanted - extent[i]) / 2;
    extent[i] = wanted;
  }
  Cells best{.pixels_per_metre = 0};
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double across = (plot_width / static_cast<double>(columns) - 2 * air_pixels) / extent[0];
    const double upwards = (highest_strip / rows - 2 * air_pixels - label_pixels) / extent[1];
    const double scale = std::min(across, upwards);
    if (!(scale > best.pixels_per_metre)) continue;
    best = {.pixels_per_metre = scale, .columns = columns, .rows = rows};
  }
  // The whole width is used; the height is what is needed.
  best.size = {plot_width / (best.columns * best.pixels_per_metre),
               extent[1] + (2 * air_pixels + label_pixels) / best.pixels_per_metre};
  best.least = {least[0] - (best.size[0] - extent[0]) / 2,
                least[1] - air_pixels / best.pixels_per_metre};
  return best;
}

/// The part of a convex outline within limits of one of its coordinates (Sutherland and Hodgman).
Eigen::Matrix3Xd clipped(const Eigen::Matrix3Xd& outline, int axis, double limit, double sign) {
  std::vector<Eigen::Vector3d> kept;
  const Eigen::Index count = outline.cols();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d a = outline.col(i);
    const Eigen::Vector3d b = outline.col((i + 1) % count);
    const double before = sign * (limit - a[axis]);
    const double after = sign * (limit - b[axis]);
    if (before >= 0) kept.push_back(a);
    if ((before >= 0) != (after >= 0)) kept.emplace_back(a + (b - a) * (before / (before - after)));
  }
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = kept[i];
  return result;
}

Series within_cell(Series series, const View& view, const Cells& cells) {
  const std::array<int, 2> axes = {view.right, view.up};
  for (std::size_t i = 0; i < 2; ++i) {
    series.points = clipped(series.points, axes[i], cells.least[i], -1);
    series.points = clipped(series.points, axes[i], cells.least[i] + cells.size[i], 1);
  }
  series.arc_length.assign(static_cast<std::size_t>(series.points.cols()), NAN);
  return series;
}

/// What a cell shows.
std::vector<Series> series_of(const Scene& now, const Track& track, const TrackFrame& frame,
                              const View& view, const Cells& cells) {
  std::vector<Series> all;
  for (Series& outline : obstacle_series(now, {view}, frame.points)) {
    Series seen = within_cell(std::move(outline), view, cells);
    if (!seen.arc_length.empty()) all.push_back(std::move(seen));
  }
  if (frame.force) {
    all.push_back({.id = "force",
                   .title = "force model, on the way",
                   .style = "with lines linecolor rgb '#B34700' linewidth 1.5 dashtype 2",
                   .points = frame.force->shape.points,
                   .arc_length = frame.force->shape.arc_length});
  }
  all.push_back({.id = "energy",
                 .title = "energy model (the rod itself), at rest",
                 .style = "with lines linecolor rgb 'black' linewidth 2 dashtype 1",
                 .points = frame.points,
                 .arc_length = track.arc_length});
  const Shape shape{.arc_length = track.arc_length, .points = frame.points};
  const RodPoints points = [&](const std::vector<double>& s) { return resample(shape, s).points; };
  if (auto contact = contact_series(frame.contacts, points, now.length)) {
    all.push_back(std::move(*contact));
  }
  for (Series& gripper : gripper_series(now)) all.push_back(std::move(gripper));
  return all;
}

Figure strip_figure(const Scene& scene, const Track& track, const TrackOptions& options,
                    std::size_t number) {
  Figure figure{.name = fmt::format("strip_{}", number),
                .section = "motion",
                .title = scene.name + ": shapes over time",
                .csv_file = fmt::format("strip_{}.csv", number)};
  const FrameClock clock(scene, {.from = options.from, .to = options.to}, options.rates);
  const Eigen::Matrix3Xd points = points_of(track);
  const View view = views_of(scene_at(scene, track.frames.front().time), points).front();
  const std::vector<std::size_t> frames = shown_frames(track.frames.size());
  const Cells cells = cells_for(points, view, static_cast<int>(frames.size()));
  Panel panel{
      .height = static_cast<int>(std::lround(cells.rows * cells.size[1] * cells.pixels_per_metre)),
      .x_label =
          fmt::format("{} [m]; a cell is {:.3g} m wide", axis_names[view.right], cells.size[0]),
      .y_label = fmt::format("{} [m]", axis_names[view.up])};
  panel.script = fmt::format(
      "# equal aspect: {:.6g} pixels a metre on both axes\n"
      "set xrange [0:{:.6g}]\nset yrange [0:{:.6g}]\nset xtics 0,{:.6g} scale 0\n"
      "set ytics 0,{:.6g} scale 0\nset format ''\n",
      cells.pixels_per_metre, cells.columns * cells.size[0], cells.rows * cells.size[1],
      cells.size[0], cells.size[1]);
  std::vector<Series> written;
  std::set<std::string> titles;
  std::string plots;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TrackFrame& frame = track.frames[frames[i]];
    const std::array<double, 2> shift = cells.shift(static_cast<int>(i));
    fmt::format_to(
        std::back_inserter(panel.script),
        "set label {} 't = {:.4g} s' at {:.6g},{:.6g} left front\n", i + 100, frame.time,
        cells.least[0] + shift[0] + 4 / cells.pixels_per_metre,
        cells.least[1] + shift[1] + cells.size[1] - label_pixels / 2 / cells.pixels_per_metre);
    for (Series& series : series_of(clock.scene(scene, frames[i]), track, frame, view, cells)) {
      series.id += fmt::format("_{}", i + 1);
      const bool titled = !series.title.empty() && titles.insert(series.title).second;
      if (titled) ++panel.key_rows;
      fmt::format_to(std::back_inserter(plots), "{}{} {} {}", plots.empty() ? "plot " : ", \\\n  ",
                     series_data(figure.csv_file, series.id,
                                 fmt::format("${}{:+.8g}", view.right + 3, shift[0]),
                                 fmt::format("(${}{:+.8g})", view.up + 3, shift[1])),
                     titled ? "title " + gnuplot_string(series.title) : std::string("notitle"),
                     series.style);
      written.push_back(std::move(series));
    }
  }
  panel.script += plots + "\n";
  figure.csv = series_csv(written);
  figure.description = fmt::format(
      "{} shapes of {}, from {:.4g} to {:.4g} s, row by row, all at one scale and at equal aspect.",
      frames.size(), scene.name, track.frames.front().time, track.frames.back().time);
  figure.panels = {std::move(panel)};
  return figure;
}

/// Where something happens, as upright lines behind the curves, and their row of the key.
void add_events(const Track& track, TrackEvent::Kind kind, const char* title, const char* line,
                Panel& panel, std::string& plots) {
  bool any = false;
  for (const TrackEvent& event : track.events) {
    if (event.kind != kind) continue;
    any = true;
    fmt::format_to(std::back_inserter(panel.script),
                   "set arrow from {0:.8g}, graph 0 to {0:.8g}, graph 1 nohead back {1}\n",
                   track.frames[event.frame].time, line);
  }
  if (!any) return;
  ++panel.key_rows;
  fmt::format_to(std::back_inserter(plots), ", \\\n  NaN title '{}' with lines {}", title, line);
}

Figure force_figure(const Scene& scene, const Track& track, std::size_t number) {
  Figure figure{.name = fmt::format("forces_{}", number),
                .section = "motion",
                .title = scene.name + ": forces of the grippers",
                .description =
                    "Amount of each gripper's force on the energy model's rod against "
                    "time; upright lines where something begins or ends to touch, and "
                    "where the rod snaps.",
                .csv_file = fmt::format("forces_{}.csv", number),
                .csv = "time_s,gripper,force_N\n"};
  for (const TrackFrame& frame : track.frames) {
    for (std::size_t i = 0; i < frame.grippers.size(); ++i) {
      fmt::format_to(std::back_inserter(figure.csv), "{},{},{}\n", csv_number(frame.time), i + 1,
                     csv_number(frame.grippers[i].force.norm()));
    }
  }
  Panel panel{.x_label = "time [s]", .y_label = "force of a gripper [N]"};
  std::string plots;
  const int lines = std::min(static_cast<int>(scene.grippers.size()), most_lines);
  for (int i = 0; i < lines; ++i) {
    fmt::format_to(
        std::back_inserter(plots),
        "{}'{}' skip 1 using ($2 == {} ? $1 : NaN):3 title 'gripper {} at s = {:.4g} m' {}",
        i == 0 ? "plot " : ", \\\n  ", figure.csv_file, i + 1, i + 1,
        scene.grippers[static_cast<std::size_t>(i)].at,
        curve_style(static_cast<std::size_t>(i), "lines"));
    ++panel.key_rows;
  }
  add_events(track, TrackEvent::Kind::contact, "begins to touch, or to lie",
             "linecolor rgb '#207A34' linewidth 1 dashtype 2", panel, plots);
  add_events(track, TrackEvent::Kind::release, "ends to",
             "linecolor rgb '#707070' linewidth 1 dashtype 3", panel, plots);
  add_events(track, TrackEvent::Kind::snap, "snaps",
             "linecolor rgb '#C00000' linewidth 1.5 dashtype 1", panel, plots);
  panel.script += "set yrange [0:*]\n" + plots + "\n";
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

TrackFigures track_figures(const Scene& scene, const Track& track, const TrackOptions& options,
                           std::size_t number) {
  return {.strip = strip_figure(scene, track, options, number),
          .forces = force_figure(scene, track, number)};
}

Picture track_picture(const Scene& scene, const Track& track, const TrackOptions& options) {
  TrackFigures figures = track_figures(scene, track, options, 1);
  return {{{{std::move(figures.strip)}, {std::move(figures.forces)}}}};
}

}  // namespace dlo::compare
