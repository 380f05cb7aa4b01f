#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "format/json.hpp"
#include "motion/dynamic_track.hpp"
#include "motion/scene_modes.hpp"
#include "motion/track.hpp"
#include "recording/motion_check.hpp"
#include "recording/motion_fit.hpp"

namespace dlo::cli {

/// Which frames of a track are written.
struct TrackFrames {
  int every = 1;        ///< that many frames from one to the next; events' frames and the last too
  bool points = false;  ///< in JSON with their shapes

  /// Indices of these frames.
  [[nodiscard]] std::vector<std::size_t> of(const compare::Track& track) const;
};

[[nodiscard]] std::string track_text(const compare::Track& track, const compare::Scene& scene,
                                     const compare::TrackOptions& options);
/// @param dynamic  its moving rod, or null
[[nodiscard]] std::string track_json(const compare::Track& track, const compare::Scene& scene,
                                     const compare::TrackOptions& options,
                                     const TrackFrames& frames,
                                     const compare::DynamicTrack* dynamic = nullptr);
/// A row a frame. @param dynamic  its moving rod, or null
[[nodiscard]] std::string track_csv(const compare::Track& track, const compare::Scene& scene,
                                    const TrackFrames& frames,
                                    const compare::DynamicTrack* dynamic = nullptr);

/// Indices of the frames that a table of text shows, from the first to the last.
[[nodiscard]] std::vector<std::size_t> listed_frames(std::size_t count);

/// Lines of a force model's lag, and of why and when a track has stopped; empty without one.
[[nodiscard]] std::string lag_text(double lag, double error_without_lag);
[[nodiscard]] std::string stop_text(const std::optional<compare::TrackStop>& stop);

/// Why it has stopped, and when.
[[nodiscard]] Json stop_json(const compare::TrackStop& stop);

/// What comes below the text of its track.
[[nodiscard]] std::string dynamic_text(const compare::DynamicTrack& dynamic);

/// The key `dynamic` of its track's document.
[[nodiscard]] Json dynamic_json(const compare::DynamicTrack& dynamic, const compare::Track& track,
                                const TrackFrames& frames);

/// A frame of it. @param points  whether its shape too
[[nodiscard]] Json moving_frame_json(const compare::DynamicFrame& frame, bool points);

/// Writes frames for ParaView: the series file, which tells the times, and beside it a polyline a
/// frame, as `NAME_0000.vtk` of NAME.vtk.series. The series comes last, when all of it is there.
/// @param dynamic  its moving rod, whose shapes are written then, or null
/// @throws compare::OutputError naming what cannot be written
void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file,
                  const compare::DynamicTrack* dynamic = nullptr);

/// Modes as a person reads them.
/// @param rate  steps of the force model a second
[[nodiscard]] std::string modes_text(const compare::SceneModes& modes, const compare::Scene& scene,
                                     double rate);

/// @param samples  points of each mode's shape
[[nodiscard]] Json modes_json(const compare::SceneModes& modes, const compare::Scene& scene,
                              double rate, int samples);

[[nodiscard]] std::string modes_csv(const compare::SceneModes& modes);

/// @param verdict  "pass" or "fail", as a terminal shows it; empty: as it is
[[nodiscard]] std::string motion_check_text(const compare::MotionCheck& check,
                                            const std::string& verdict = {});
/// The document `dlo/motion_check/1`.
[[nodiscard]] Json motion_check_json(const compare::MotionCheck& check);
/// A row a frame.
[[nodiscard]] std::string motion_check_csv(const compare::MotionCheck& check);

[[nodiscard]] std::string motion_fit_text(const compare::MotionFit& fit,
                                          const compare::Scene& scene);
[[nodiscard]] Json motion_fit_json(const compare::MotionFit& fit, const compare::Scene& scene);

/// Returns stiffness and damping that were found from recordings, with the scene's mass, for
/// --calibrated. @throws compare::ConvergenceError if the stiffness is not identified, InputError
/// as add_rod_lines()
[[nodiscard]] std::string motion_toml(const compare::MotionFit& fit, const compare::Scene& scene);

}  // namespace dlo::cli
