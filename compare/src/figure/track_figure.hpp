#pragma once

#include <cstddef>

#include "dlo/compare/scene.hpp"
#include "figure/layout.hpp"
#include "motion/track.hpp"

namespace dlo::compare {

/// What figures show of a scene's motion.
struct TrackFigures {
  Figure strip;   ///< nine shapes, or all if they are fewer, equally far apart in time
  Figure forces;  ///< of every gripper against time, with contacts and snaps
};

/// @param options  that the track was made with
/// @param number   part of their names, from 1
[[nodiscard]] TrackFigures track_figures(const Scene& scene, const Track& track,
                                         const TrackOptions& options, std::size_t number);

/// Both beside each other.
[[nodiscard]] Picture track_picture(const Scene& scene, const Track& track,
                                    const TrackOptions& options);

}  // namespace dlo::compare
