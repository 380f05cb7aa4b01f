#pragma once

#include "dlo/compare/scene.hpp"
#include "figure/layout.hpp"
#include "motion/dynamic_track.hpp"
#include "motion/track.hpp"

namespace dlo::compare {

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
