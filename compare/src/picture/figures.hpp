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

/// What a picture shows of their shapes.
[[nodiscard]] Drawing solution_drawing(const Scene& scene, const std::vector<Solution>& solutions);

/// Solutions of one scene: shapes at equal aspect with grippers, obstacles and contact, beside
/// their curvature. Unstable ones are dashed.
/// @param solutions  one or more, of one model
[[nodiscard]] Picture solution_picture(const Scene& scene, const std::vector<Solution>& solutions);

/// "law paper, bookkeeping paper, N = 16".
[[nodiscard]] std::string setting_name(const ForceModelSettings& settings);

/// What a picture shows of a scene's shapes.
[[nodiscard]] Drawing comparison_drawing(const Scene& scene, const Comparison& comparison);

/// Figures of a comparison.
struct ComparisonFigures {
  Figure shapes;     ///< of both models, at equal aspect
  Figure curvature;  ///< along the rod
  Figure deviation;  ///< distance of the force model from the rod, along the rod
};

/// Draws a comparison of a scene.
[[nodiscard]] ComparisonFigures comparison_figures(const Scene& scene,
                                                   const Comparison& comparison);

/// Points of a file, joined.
[[nodiscard]] Series file_series(const Shape& file);

/// From each point of the rod to the file's. @param rod  at the same arc lengths
[[nodiscard]] Series distance_series(const Shape& file, const Shape& rod);

/// How the worst point or frame is marked.
[[nodiscard]] Look worst_look();

/// Levels of distances in a plot against what is along x: the RMS, and a tolerance. One far above
/// all distances would flatten them: it is then in words only. The plot's axis begins at 0.
/// @param largest_m  of what is drawn;  @param length  of the rod [m]
void add_levels(Panel& panel, double rms_m, std::optional<double> allowed_m, double largest_m,
                double length);

/// What a picture shows of a check's shapes.
[[nodiscard]] Drawing check_drawing(const Scene& scene, const ShapeCheck& check);

/// A measured shape on the rod of its scene, distances as whiskers from the rod to the points, the
/// worst point circled; beside it the distances along the rod.
/// @param allowed_m  a tolerance, drawn as a level
[[nodiscard]] Picture check_picture(const Scene& scene, const ShapeCheck& check,
                                    std::optional<double> allowed_m = std::nullopt);

/// Draws the error budget of a comparison as bars, one part below the other: its share of the total
/// with sign, and its RMS in words. Parts of less than 0.005 % are omitted.
[[nodiscard]] Figure budget_figure(const Comparison& comparison);

/// A fitted material: each shape's points on the rod that was fitted, and the profile likelihood
/// of the stiffness with its interval.
/// @param scenes  one for each of the fit's shapes
/// @param fit     with MaterialFitOptions::profile_points
[[nodiscard]] Picture fit_picture(const std::vector<Scene>& scenes, const MaterialFit& fit);

/// Error against time of a scene's static runs, and the line of those that no other run beats in
/// both. For scenes that have runs.
[[nodiscard]] Figure front_figure(const SceneBenchmark& scene);

/// The grid of a map, each point by what became of the rod, and its limits.
[[nodiscard]] Figure map_figure(const StabilityMap& map);

/// The frame of a recording that is the farthest from the rod, where grippers and obstacles are
/// then; where the recording is late or early, also the rod at the time that it shows.
[[nodiscard]] Drawing worst_frame_drawing(const MotionCheck& check);

/// That frame, and beside it the distance of each frame from the rod against time, the worst one
/// circled, and what is left of it without a lag.
[[nodiscard]] Picture motion_check_picture(const MotionCheck& check);

/// A field of a sweep.
struct SweptField {
  std::string column;               ///< its name in the table
  std::vector<std::string> values;  ///< as the table spells them, in the sweep's order
  bool logarithmic = false;         ///< the values are spread so
};

/// What can be told of a picture before the sweep is computed.
/// @throws InputError if there are other than one or two fields, or the first of two and a single
/// one has values that are no numbers
void require_drawable(const std::vector<SweptField>& fields);

/// A sweep over one field as lines, over two as lines for each value of the second where these are
/// few or no numbers, else as maps.
/// @param fields   one or two;  @param header, rows  of the table (CSV), with their line ends
/// @param results  columns that are drawn, a figure each
/// @throws InputError as require_drawable(), or if there is no such column
[[nodiscard]] Picture sweep_picture(const std::vector<SweptField>& fields,
                                    const std::string& header, const std::vector<std::string>& rows,
                                    const std::vector<std::string>& results);

/// What is drawn of a motion.
struct TrackShapes {
  const Track& track;
  const DynamicTrack* moving = nullptr;  ///< its rod with inertia, or null

  /// Whether that has a frame, too: it may have had to stop earlier.
  [[nodiscard]] bool has_moving(std::size_t frame) const {
    return moving != nullptr && frame < moving->frames.size();
  }
};

/// What figures show of a scene's motion.
struct TrackFigures {
  Figure strip;   ///< nine shapes, or all if they are fewer, equally far apart in time
  Figure forces;  ///< and torques of up to three grippers against time, with contacts and snaps
};

/// @param options  that the track was made with
[[nodiscard]] TrackFigures track_figures(const Scene& scene, const TrackShapes& shapes,
                                         const TrackOptions& options);

/// Both beside each other.
[[nodiscard]] Picture track_picture(const Scene& scene, const TrackShapes& shapes,
                                    const TrackOptions& options);

}  // namespace dlo::compare
