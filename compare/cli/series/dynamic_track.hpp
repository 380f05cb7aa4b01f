#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "format/json.hpp"
#include "motion/dynamic_track.hpp"
#include "series/track.hpp"

namespace dlo::cli {

/// What comes below the text of its track.
[[nodiscard]] std::string dynamic_text(const compare::DynamicTrack& dynamic);

/// The key `dynamic` of its track's document.
[[nodiscard]] Json dynamic_json(const compare::DynamicTrack& dynamic, const compare::Track& track,
                                const TrackFrames& frames);

/// Columns of CSV behind those of its track, each with a comma before it.
[[nodiscard]] std::string dynamic_csv_header(std::size_t grippers, std::size_t obstacles);
/// The same of a frame; empty fields behind the last one. @param index  of the track's frames
[[nodiscard]] std::string dynamic_csv_fields(const compare::DynamicTrack& dynamic,
                                             std::size_t grippers, std::size_t obstacles,
                                             std::size_t index);

}  // namespace dlo::cli
