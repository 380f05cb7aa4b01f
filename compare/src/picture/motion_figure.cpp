#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "figure/series.hpp"
#include "picture/figures.hpp"

namespace dlo::compare {
namespace {

constexpr const char* green = "#207A34";

Series worst_point(const MotionCheck& check) {
  const FrameShapes& shapes = check.worst_shapes;
  const FrameError& worst = check.worst_frame_error();
  Series series{.id = "worst",
                .title = fmt::format("worst: s = {:.4g} m, {:.4g} mm", worst.largest_at_m,
                                     worst.largest_m * 1e3),
                .look = worst_point_style()};
  for (std::size_t i = 0; i < shapes.recorded.arc_length.size(); ++i) {
    if (shapes.recorded.arc_length[i] != worst.largest_at_m) continue;
    series.points = shapes.recorded.points.col(static_cast<Eigen::Index>(i));
  }
  return series;
}

PlottedCurve curve_of(const std::vector<FrameError>& frames, double FrameError::*value) {
  PlottedCurve curve;
  curve.x.reserve(frames.size());
  curve.y.reserve(frames.size());
  for (const FrameError& frame : frames) {
    curve.x.push_back(frame.time);
    curve.y.push_back(frame.*value * 1e3);
  }
  return curve;
}

Figure error_figure(const MotionCheck& check) {
  const MotionErrors& errors = check.errors;
  Panel panel{.height = 280,
              .x = {.label = "time [s]",
                    .from = errors.frames.front().time,
                    .to = errors.frames.back().time},
              .y = {.label = "distance from the rod [mm]"}};
  const auto add = [&](PlottedCurve curve, std::string title, CurveStyle look) {
    curve.title = std::move(title);
    curve.look = std::move(look);
    panel.curves.push_back(std::move(curve));
  };
  add(curve_of(errors.frames, &FrameError::largest_m), "largest of each frame",
      {.colour = "#B34700", .width = 1, .dashes = Dashes::dash_dotted});
  add(curve_of(errors.frames, &FrameError::rms_m), "RMS of each frame",
      {.colour = "#0059A8", .width = 2});
  if (!check.frames_without_lag.empty()) {
    add(curve_of(check.frames_without_lag, &FrameError::rms_m),
        fmt::format("RMS if it were not {:.4g} ms {}", std::abs(check.lag) * 1e3,
                    check.lag > 0 ? "late" : "early"),
        {.colour = green, .width = 2, .dashes = Dashes::dashed});
  }
  add({.x = {check.worst_frame_error().time}, .y = {check.worst_frame_error().rms_m * 1e3}},
      fmt::format("the worst frame, at {:.4g} s", check.worst_frame_error().time),
      worst_point_style());
  add_levels(panel, errors.rms_m, check.tolerance.allowed_m, errors.largest_m, check.scene.length);
  return {.title = "Distance of each frame", .panels = {std::move(panel)}};
}

}  // namespace

Drawing worst_frame_drawing(const MotionCheck& check) {
  const FrameShapes& shapes = check.worst_shapes;
  const Scene now = scene_at(check.scene, shapes.time);
  const std::vector<View> views =
      views_of(now, concatenated({&shapes.rod.points, &shapes.recorded.points}));
  std::vector<Series> all = obstacle_series(now, views, shapes.rod.points);
  all.push_back(distance_series(shapes.recorded, shapes.on_rod));
  if (shapes.rod_at_other_time) {
    all.push_back({.id = "rod_at_other_time",
                   .title = fmt::format("the rod {:.4g} ms {}", std::abs(check.lag) * 1e3,
                                        check.lag > 0 ? "earlier" : "later"),
                   .look = {.colour = green, .width = 2, .dashes = Dashes::dashed},
                   .points = shapes.rod_at_other_time->points});
  }
  all.push_back(
      {.id = "rod",
       .title = check.model == MotionModel::at_rest ? "the rod at rest" : "the rod with inertia",
       .look = {.width = 2},
       .points = shapes.rod.points});
  all.push_back(file_series(shapes.recorded));
  for (Series& gripper : gripper_series(now)) all.push_back(std::move(gripper));
  all.push_back(worst_point(check));
  return {views, std::move(all)};
}

Picture motion_check_picture(const MotionCheck& check) {
  Figure shapes{.title = fmt::format("{}: the worst frame, at {:.4g} s", check.scene.name,
                                     check.worst_frame_error().time),
                .panels = shape_panels(worst_frame_drawing(check))};
  return {{{{std::move(shapes)}, {error_figure(check)}}}};
}

}  // namespace dlo::compare
