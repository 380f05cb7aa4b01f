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

/// Frames of a track that are written.
struct TrackFrames {
  int every = 1;        ///< interval of frames; frames with events and the last frame are added
  bool points = false;  ///< whether JSON contains their shapes

  /// Returns the indices of these frames.
  [[nodiscard]] std::vector<std::size_t> of(const compare::Track& track) const;
};

[[nodiscard]] std::string track_text(const compare::Track& track, const compare::Scene& scene,
                                     const compare::TrackOptions& options);
/// Returns a track as JSON. @param dynamic  its rod with inertia, or null
[[nodiscard]] std::string track_json(const compare::Track& track, const compare::Scene& scene,
                                     const compare::TrackOptions& options,
                                     const TrackFrames& frames,
                                     const compare::DynamicTrack* dynamic = nullptr);
/// Returns one row per frame. @param dynamic  its rod with inertia, or null
[[nodiscard]] std::string track_csv(const compare::Track& track, const compare::Scene& scene,
                                    const TrackFrames& frames,
                                    const compare::DynamicTrack* dynamic = nullptr);

/// Returns the indices of the frames in a text table, including the first and the last.
[[nodiscard]] std::vector<std::size_t> listed_frames(std::size_t count);

/// Return lines with a force model's lag, and with reason and time of a track's end; empty without
/// one.
[[nodiscard]] std::string lag_text(double lag, double error_without_lag);
[[nodiscard]] std::string stop_text(const std::optional<compare::TrackStop>& stop);

/// Returns reason and time of a track's end.
[[nodiscard]] Json stop_json(const compare::TrackStop& stop);

/// Returns the text of a rod with inertia, which follows that of its track.
[[nodiscard]] std::string dynamic_text(const compare::DynamicTrack& dynamic);

/// Returns the value of the key `dynamic` of the track's document.
[[nodiscard]] Json dynamic_json(const compare::DynamicTrack& dynamic, const compare::Track& track,
                                const TrackFrames& frames);

/// Returns a frame of a rod with inertia. @param points  whether its shape is included
[[nodiscard]] Json moving_frame_json(const compare::DynamicFrame& frame, bool points);

/// Writes frames for ParaView: a series file with the times, and one polyline file per frame,
/// `NAME_00000.vtk` for NAME.vtk.series. The series file is written last, when all frames are.
/// @param dynamic  rod with inertia, whose shapes are then written, or null
/// @throws compare::OutputError naming the file that cannot be written
void write_series(const compare::Track& track, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file,
                  const compare::DynamicTrack* dynamic = nullptr);

/// Returns modes as text.
/// @param rate  steps of the force model per second
[[nodiscard]] std::string modes_text(const compare::SceneModes& modes, const compare::Scene& scene,
                                     double rate);

/// Returns modes as JSON. @param samples  points of each mode shape
[[nodiscard]] Json modes_json(const compare::SceneModes& modes, const compare::Scene& scene,
                              double rate, int samples);

[[nodiscard]] std::string modes_csv(const compare::SceneModes& modes);

/// Returns a motion check as text. @param verdict  coloured "pass" or "fail" for a terminal; empty:
/// not coloured
[[nodiscard]] std::string motion_check_text(const compare::MotionCheck& check,
                                            const std::string& verdict = {});
/// Returns the document `dlo/motion_check/1`.
[[nodiscard]] Json motion_check_json(const compare::MotionCheck& check);
/// Returns one row per frame.
[[nodiscard]] std::string motion_check_csv(const compare::MotionCheck& check);

[[nodiscard]] std::string motion_fit_text(const compare::MotionFit& fit,
                                          const compare::Scene& scene);
[[nodiscard]] Json motion_fit_json(const compare::MotionFit& fit, const compare::Scene& scene);

/// Returns stiffness and damping that were fitted to recordings, with the scene's mass, for
/// --calibrated. @throws compare::ConvergenceError if the stiffness is not identified, InputError
/// as add_rod_lines()
[[nodiscard]] std::string motion_toml(const compare::MotionFit& fit, const compare::Scene& scene);

}  // namespace dlo::cli
