#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "figure/series.hpp"
#include "motion/frame_clock.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

constexpr std::size_t most_shapes = 9;
constexpr double highest_strip = 420;  // [pixels]
constexpr double label_pixels = 20;    // height of the time label of a cell, above its shape
constexpr double margin_pixels = 10;   // margin around the shape of a cell
constexpr std::size_t most_drawn_grippers = 3;  // half the number of different curve styles
constexpr int load_plot = 190;                  // height [pixels]

/// Returns the indices of frames at about equal intervals, including the first and the last.
std::vector<std::size_t> shown_frames(std::size_t count) {
  const std::size_t shown = std::min(count, most_shapes);
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < shown; ++i) {
    frames.push_back(shown > 1 ? (i * (count - 1) + (shown - 1) / 2) / (shown - 1) : 0);
  }
  return frames;
}

/// Returns all points that are drawn in some frames.
Eigen::Matrix3Xd points_of(const TrackShapes& shapes, const std::vector<std::size_t>& frames) {
  std::vector<const Eigen::Matrix3Xd*> parts;
  for (const std::size_t i : frames) {
    const TrackFrame& frame = shapes.track.frames[i];
    parts.push_back(&frame.shape.points);
    if (frame.force) parts.push_back(&frame.force->shape.points);
    if (shapes.has_moving(i)) parts.push_back(&shapes.moving->frames[i].points);
  }
  return concatenated(parts);
}

/// Grid of cells of equal size, each with one shape, all at the same scale.
struct Cells {
  std::array<double, 2> least = {0, 0};  ///< coordinates at the lower left corner of a cell [m]
  std::array<double, 2> size = {1, 1};   ///< width and height of a cell [m]
  double pixels_per_metre = 1;
  int columns = 1, rows = 1;

  /// Returns the translation of coordinates into a cell [m]; the lowest row begins at 0.
  [[nodiscard]] std::array<double, 2> shift(int cell) const {
    const int row_above_lowest = rows - 1 - cell / columns;
    return {cell % columns * size[0] - least[0], row_above_lowest * size[1] - least[1]};
  }
  /// Returns an axis with lines between the cells, but without numbers.
  [[nodiscard]] PlotAxis axis(std::size_t i, std::string label) const {
    const int count = i == 0 ? columns : rows;
    PlotAxis axis{.label = std::move(label), .from = 0, .to = count * size[i], .tics = {{}}};
    for (int k = 0; k <= count; ++k) axis.tics->push_back({k * size[i], ""});
    return axis;
  }
};

/// Returns the grid with the number of columns for which the scale is largest.
Cells cells_for(const Eigen::Matrix3Xd& points, const View& view, int count) {
  const std::array<int, 2> axes = {view.right, view.up};
  std::array<double, 2> least{};
  std::array<double, 2> extent{};
  for (std::size_t i = 0; i < 2; ++i) {
    least[i] = points.row(axes[i]).minCoeff();
    extent[i] = points.row(axes[i]).maxCoeff() - least[i];
  }
  const double largest = std::max(extent[0], extent[1]);
  for (std::size_t i = 0; i < 2; ++i) {  // a straight rod gets some height too
    const double wanted = std::max(extent[i], 0.2 * largest);
    least[i] -= (wanted - extent[i]) / 2;
    extent[i] = wanted;
  }
  Cells best{.pixels_per_metre = 0};
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double across =
        (plot_width / static_cast<double>(columns) - 2 * margin_pixels) / extent[0];
    const double upwards = (highest_strip / rows - 2 * margin_pixels - label_pixels) / extent[1];
    const double scale = std::min(across, upwards);
    if (!(scale > best.pixels_per_metre)) continue;
    best = {.pixels_per_metre = scale, .columns = columns, .rows = rows};
  }
  // The cells fill the whole width; their height is what the shapes need.
  best.size = {plot_width / (best.columns * best.pixels_per_metre),
               extent[1] + (2 * margin_pixels + label_pixels) / best.pixels_per_metre};
  best.least = {least[0] - (best.size[0] - extent[0]) / 2,
                least[1] - margin_pixels / best.pixels_per_metre};
  return best;
}

/// Returns the series that a cell shows.
std::vector<Series> series_of(const Scene& now, const TrackShapes& shapes, std::size_t index,
                              const View& view, const Cells& cells) {
  const TrackFrame& frame = shapes.track.frames[index];
  std::vector<Series> all;
  for (Series& outline : obstacle_series(now, {view}, frame.shape.points)) {
    Series visible = within(std::move(outline), view, cells.least,
                            {cells.least[0] + cells.size[0], cells.least[1] + cells.size[1]});
    if (visible.points.cols() > 0) all.push_back(std::move(visible));
  }
  if (frame.force) {
    all.push_back({.id = "force",
                   .title = "force model, on the way",
                   .look = {.colour = "#B34700", .width = 1.5, .dashes = Dashes::dashed},
                   .points = frame.force->shape.points});
  }
  if (shapes.has_moving(index)) {
    all.push_back({.id = "moving",
                   .title = "the rod with inertia",
                   .look = {.colour = "#0059A8", .width = 1.5},
                   .points = shapes.moving->frames[index].points});
  }
  all.push_back({.id = "energy",
                 .title = "energy model (the rod itself), at rest",
                 .look = {.width = 2},
                 .points = frame.shape.points});
  const Shape& shape = frame.shape;
  const RodPoints points = [&](const std::vector<double>& s) { return resample(shape, s).points; };
  if (auto contact = contact_series(frame.contacts, points, now.length)) {
    all.push_back(std::move(*contact));
  }
  for (Series& gripper : gripper_series(now)) {
    // Clamps are thinner than in a plot of a single shape.
    if (gripper.look.width > 0) gripper.look.width = 3;
    gripper.look.mark_size = 0.7;
    all.push_back(std::move(gripper));
  }
  return all;
}

Figure strip_figure(const Scene& scene, const TrackShapes& shapes, const TrackOptions& options) {
  const Track& track = shapes.track;
  const FrameClock clock(scene, {.from = options.from, .to = options.to}, options.rates);
  const std::vector<std::size_t> frames = shown_frames(track.frames.size());
  const Eigen::Matrix3Xd points = points_of(shapes, frames);
  const View view = views_of(scene_at(scene, track.frames.front().time), points).front();
  const Cells cells = cells_for(points, view, static_cast<int>(frames.size()));
  Panel panel{
      .height = static_cast<int>(std::lround(cells.rows * cells.size[1] * cells.pixels_per_metre)),
      .x = cells.axis(
          0, fmt::format("{} [m]; a cell is {:.3g} m wide", axis_names[view.right], cells.size[0])),
      .y = cells.axis(1, fmt::format("{} [m]", axis_names[view.up])),
      .equal_aspect = true};
  std::set<std::string> titles;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const TrackFrame& frame = track.frames[frames[i]];
    const std::array<double, 2> shift = cells.shift(static_cast<int>(i));
    panel.texts.push_back({.x = cells.least[0] + shift[0],
                           .y = cells.least[1] + shift[1] + cells.size[1],
                           .words = fmt::format("t = {:.4g} s", frame.time),
                           .dx = 4,
                           .dy = -label_pixels / 2});
    for (const Series& series :
         series_of(clock.scene(scene, frames[i]), shapes, frames[i], view, cells)) {
      PlottedCurve curve{.id = fmt::format("{}_{}", series.id, i + 1), .look = series.look};
      if (titles.insert(series.title).second) curve.title = series.title;
      for (const auto& point : series.points.colwise()) {
        curve.x.push_back(point[view.right] + shift[0]);
        curve.y.push_back(point[view.up] + shift[1]);
      }
      panel.curves.push_back(std::move(curve));
    }
  }
  return {.title = scene.name + ": shapes over time", .panels = {std::move(panel)}};
}

/// Draws the magnitude of the load of up to three grippers against time, and marks events.
/// @param load  force or torque of a gripper
Panel load_panel(const Scene& scene, const TrackShapes& shapes, const char* label,
                 Eigen::Vector3d GripperLoad::*load) {
  Panel panel{.height = load_plot,
              .x = {.label = "time [s]",
                    .from = shapes.track.frames.front().time,
                    .to = shapes.track.frames.back().time},
              .y = {.label = label, .from = 0}};
  const auto add = [&](const auto& frames, std::size_t gripper, const char* rod, std::size_t look) {
    PlottedCurve curve{.title = fmt::format("gripper {} at s = {:.4g} m{}", gripper + 1,
                                            scene.grippers[gripper].at, rod),
                       .look = curve_style(look)};
    curve.look.mark = Mark::none;
    for (const auto& frame : frames) {
      curve.x.push_back(frame.time);
      curve.y.push_back((frame.grippers[gripper].*load).norm());
    }
    panel.curves.push_back(std::move(curve));
  };
  for (std::size_t i = 0; i < scene.grippers.size() && i < most_drawn_grippers; ++i) {
    add(shapes.track.frames, i, "", 2 * i);
    if (shapes.moving == nullptr) continue;
    add(shapes.moving->frames, i, ", the rod with inertia", 2 * i + 1);
  }
  const auto mark = [&](TrackEvent::Kind kind, const char* title, const CurveStyle& look) {
    PlottedCurve uprights{.title = title, .look = look};
    for (const TrackEvent& event : shapes.track.events) {
      if (event.kind != kind) continue;
      const double time = shapes.track.frames[event.frame].time;
      uprights.x.insert(uprights.x.end(), {time, time, NAN});
      uprights.y.insert(uprights.y.end(), {-HUGE_VAL, HUGE_VAL, NAN});
    }
    panel.curves.push_back(std::move(uprights));
  };
  mark(TrackEvent::Kind::contact, "begins to touch, or to lie",
       {.colour = "#207A34", .dashes = Dashes::dashed});
  mark(TrackEvent::Kind::release, "ends to", {.colour = "#707070", .dashes = Dashes::dotted});
  mark(TrackEvent::Kind::snap, "snaps", {.colour = "#C00000", .width = 1.5});
  mark(TrackEvent::Kind::lost, "may have been lost",
       {.colour = "#C00000", .width = 1.5, .dashes = Dashes::dotted});
  return panel;
}

Figure force_figure(const Scene& scene, const TrackShapes& shapes) {
  Panel force = load_panel(scene, shapes, "force [N]", &GripperLoad::force);
  force.has_legend = false;
  Panel torque = load_panel(scene, shapes, "torque [N m]", &GripperLoad::torque);
  return {.title = scene.name + ": what the grippers exert",
          .panels = {std::move(force), std::move(torque)}};
}

}  // namespace

TrackFigures track_figures(const Scene& scene, const TrackShapes& shapes,
                           const TrackOptions& options) {
  return {.strip = strip_figure(scene, shapes, options), .forces = force_figure(scene, shapes)};
}

}  // namespace dlo::compare
