#pragma once

#include <string>

#include "dlo/compare/scene.hpp"
#include "format/json.hpp"
#include "motion/dynamic_track.hpp"
#include "series/track_series.hpp"

namespace dlo::cli {

/// What comes below the text of its track.
[[nodiscard]] std::string dynamic_text(const compare::DynamicTrack& dynamic);

/// The key `dynamic` of its track's document.
[[nodiscard]] Json dynamic_json(const compare::DynamicTrack& dynamic, const compare::Track& track,
                                const TrackFrames& frames);

/// A frame of it. @param points  whether its shape too
[[nodiscard]] Json moving_frame_json(const compare::DynamicFrame& frame, bool points);

}  // namespace dlo::cli
