#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "format/json.hpp"
#include "motion/dynamic_track.hpp"
#include "motion/track.hpp"

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

}  // namespace dlo::cli
