#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solution.hpp"
#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "motion/dynamic_track.hpp"
#include "motion/track.hpp"
#include "recording/motion_check.hpp"
#include "study/benchmark.hpp"
#include "study/stability_map.hpp"

namespace dlo::compare {

/// Returns the shapes of solutions as a picture shows them.
[[nodiscard]] Drawing solution_drawing(const Scene& scene, const std::vector<Solution>& solutions);

/// Draws solutions of one scene: shapes at equal aspect with grippers, obstacles and contact, and
/// next to them their curvature. Solutions that are unstable, or not known to be stable, are
/// dashed.
/// @param solutions  one or more, of one model
[[nodiscard]] Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions);

/// Returns the settings in words, such as "law paper, bookkeeping paper, N = 16".
[[nodiscard]] std::string setting_name(const ForceModelSettings& settings);

/// Returns the shapes of a comparison as a picture shows them.
[[nodiscard]] Drawing comparison_drawing(const Scene& scene, const Comparison& comparison);

/// Figures of a comparison.
struct ComparisonFigures {
  Figure shapes;     ///< shapes of both models, at equal aspect
  Figure curvature;  ///< curvature along the rod
  Figure deviation;  ///< distance of the force model from the rod, along the rod
};

/// Draws a comparison of a scene.
[[nodiscard]] ComparisonFigures comparison_figures(const Scene& scene,
                                                   const Comparison& comparison);

/// Returns the points of a file, connected by lines.
[[nodiscard]] Series file_series(const Shape& file);

/// Returns lines from points of the rod to points of the file. @param rod  at the same arc lengths
[[nodiscard]] Series distance_series(const Shape& file, const Shape& rod);

/// Returns the style of the mark at the worst point or frame.
[[nodiscard]] CurveStyle worst_point_style();

/// Adds horizontal lines at the RMS and at a tolerance to a plot of distances. A tolerance far
/// above all distances is named only in the legend, since the plot would have to be extended to it.
/// The y axis begins at 0.
/// @param largest_m  largest drawn distance [m];  @param length  length of the rod [m]
void add_levels(Panel& panel, double rms_m, std::optional<double> allowed_m, double largest_m,
                double length);

/// Returns the shapes of a check as a picture shows them.
[[nodiscard]] Drawing check_drawing(const Scene& scene, const ShapeCheck& check);

/// Draws a measured shape on the rod of its scene, with lines from the rod to the measured points
/// and a circle at the worst point, and next to it the distances along the rod.
/// @param allowed_m  tolerance, drawn as a line [m]
[[nodiscard]] Picture check_picture(const Scene& scene, const ShapeCheck& check,
                                    std::optional<double> allowed_m = std::nullopt);

/// Draws the error budget of a comparison as bars, one part below the other: its share of the total
/// with sign, and its RMS in words. Parts of less than 0.005 % are omitted.
[[nodiscard]] Figure budget_figure(const Comparison& comparison);

/// Draws a fitted material: each shape's points on the fitted rod, and the profile likelihood of
/// the stiffness with its interval, if the fit has one.
/// @param scenes  one for each of the fit's shapes
/// @param fit     computed with MaterialFitOptions::profile_points
[[nodiscard]] Picture fit_picture(const std::vector<Scene>& scenes, const MaterialFit& fit);

/// Draws the error of a scene's static runs against their time, and the line of those that no other
/// run beats in both. The scene must have runs.
[[nodiscard]] Figure front_figure(const SceneBenchmark& scene);

/// Draws the grid of a stability map, each point by its outcome, and the limits of c_F.
[[nodiscard]] Figure map_figure(const StabilityMap& map);

/// Returns the frame of a recording that is farthest from the rod, with grippers and obstacles at
/// its time. If the recording has a lag, the rod at the shifted time is included.
[[nodiscard]] Drawing worst_frame_drawing(const MotionCheck& check);

/// Draws the worst frame, and next to it the distance of each frame from the rod against time, with
/// the worst frame circled, and the distance that remains without the lag.
[[nodiscard]] Picture motion_check_picture(const MotionCheck& check);

/// Varied field of a sweep.
struct SweptField {
  std::string column;               ///< name of its column in the table
  std::vector<std::string> values;  ///< values as the table spells them, in the sweep's order
  bool logarithmic = false;         ///< whether the values are spaced logarithmically
};

/// Checks whether a picture can be drawn, before the sweep is computed.
/// @throws InputError if there are other than one or two fields, or if a value of the first field
/// is no number
void require_drawable(const std::vector<SweptField>& fields);

/// Draws a sweep. Over one field, results are lines; over two fields, lines for each value of the
/// second field if it has few values or values that are no numbers, else maps.
/// @param fields   one or two;  @param header, rows  lines of the table (CSV), with their line ends
/// @param results  columns that are drawn, each in one figure
/// @throws InputError as require_drawable(), or if there is no such column
[[nodiscard]] Picture sweep_picture(const std::vector<SweptField>& fields,
                                    const std::string& header, const std::vector<std::string>& rows,
                                    const std::vector<std::string>& results);

/// Shapes of a motion that are drawn.
struct TrackShapes {
  const Track& track;
  const DynamicTrack* moving = nullptr;  ///< the motion with inertia, or null

  /// Whether the motion with inertia has this frame; it may have ended earlier.
  [[nodiscard]] bool has_moving(std::size_t frame) const {
    return moving != nullptr && frame < moving->frames.size();
  }
};

/// Figures of a scene's motion.
struct TrackFigures {
  Figure strip;  ///< nine shapes at about equal intervals of time, or all shapes if there are fewer
  /// Magnitudes of force and torque of up to three grippers against time, with the track's events.
  Figure forces;
};

/// Draws the figures of a motion. @param options  those with which the track was computed
[[nodiscard]] TrackFigures track_figures(const Scene& scene, const TrackShapes& shapes,
                                         const TrackOptions& options);

}  // namespace dlo::compare
