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
#include "record/csv_table.hpp"
#include "recording/motion_check.hpp"
#include "recording/motion_fit.hpp"

namespace dlo::cli {

/// Frames of a track that are written.
struct TrackFrames {
  int frame_interval = 1;  ///< interval of frames; frames with events and the last frame are added
  bool points = false;     ///< whether JSON contains their shapes

  /// Returns the indices of the frames of a track that are written.
  [[nodiscard]] std::vector<std::size_t> of(const compare::Track& track) const;
};

/// Returns the document `dlo/track/1`.
[[nodiscard]] compare::Document track_document(const compare::TrackResult& found,
                                               const compare::Scene& scene,
                                               const TrackFrames& frames);
/// Returns the document's text, with some ten frames and those of events.
[[nodiscard]] std::string track_text(const compare::TrackResult& found,
                                     const compare::Scene& scene);
/// Returns a header, then one row per frame.
[[nodiscard]] std::string track_csv(const compare::TrackResult& found, const compare::Scene& scene,
                                    const TrackFrames& frames);

/// Writes frames for ParaView: a series file with the times, and one polyline file per frame,
/// `NAME_00000.vtk` for NAME.vtk.series, numbered by the index of the frame in the track. The
/// series file is written last, when it is complete. The shapes are those of the rod with inertia,
/// if there is one.
/// @throws compare::OutputError naming the file that cannot be written
void write_series(const compare::TrackResult& found, const compare::Scene& scene,
                  const TrackFrames& frames, const std::string& file);

/// Returns the document `dlo/modes/1`.
/// @param rate  steps of the force model per second;  @param samples  points of each mode shape
[[nodiscard]] compare::Document modes_document(const compare::SceneModes& modes,
                                               const compare::Scene& scene, double rate,
                                               int samples);

/// Returns the document `dlo/motion_check/1`. Its text begins with the verdict and its reason, and
/// omits the frames.
/// @param verdict  coloured "pass" or "fail" for a terminal; empty: not coloured
[[nodiscard]] compare::Document motion_check_document(const compare::MotionCheck& check,
                                                      const std::string& verdict = {});

/// Returns the document `dlo/motion_fit/1`.
[[nodiscard]] compare::Document motion_fit_document(const compare::MotionFit& fit,
                                                    const compare::Scene& scene);

/// Returns stiffness and damping that were fitted to recordings, with the scene's mass, for
/// --calibrated. @throws compare::ConvergenceError if the stiffness is not identified, InputError
/// as add_rod_lines()
[[nodiscard]] std::string motion_toml(const compare::MotionFit& fit, const compare::Scene& scene);

}  // namespace dlo::cli
