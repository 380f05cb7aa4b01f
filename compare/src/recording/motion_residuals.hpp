#pragma once

#include <Eigen/Core>
#include <vector>

#include "recording/model_motion.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Distances of one frame of a recording from the rod.
struct FrameError {
  double time = 0;          ///< [s]
  double rms_m = 0;         ///< RMS distance of its points [m]
  double largest_m = 0;     ///< largest distance of a point [m]
  double largest_at_m = 0;  ///< arc length of that point [m]
};

/// Distances of a part of the rod, or of a marker on it, in all frames.
struct PartError {
  double from_m = 0;     ///< arc length at which it begins [m]
  double to_m = 0;       ///< arc length at which it ends [m]; equal for a marker
  double rms_m = 0;      ///< RMS distance of its points [m]
  double largest_m = 0;  ///< largest distance of a point [m]
};

/// Distances of a recording from a rod.
struct MotionErrors {
  double rms_m = 0;                ///< RMS distance of all points [m]
  double largest_m = 0;            ///< largest distance of a point [m]
  std::vector<FrameError> frames;  ///< by time
  std::size_t worst_frame = 0;     ///< index of the frame with the largest RMS
  std::vector<PartError> thirds;   ///< thirds of the rod that have points
  std::vector<PartError> markers;  ///< in the order of arc length; empty if there are too many
};

/// Largest number of markers that are listed; frames of a simulator may have any number of points.
inline constexpr std::size_t most_markers = 30;

/// Returns the recorded points minus the rod's points [m], 3 x positions.
/// @param lag  delay of the recording: the rod's points are those at time - lag [s]
[[nodiscard]] Eigen::Matrix3Xd motion_residuals(const MarkerMotion& recorded,
                                                const ModelMotion& model, double lag = 0);

/// Returns the root mean square of the norms of columns [m].
[[nodiscard]] double rms_of(const Eigen::Matrix3Xd& residuals);

/// Computes the distances from residuals. @param length  of the rod [m]
/// @param listed  largest number of markers that are listed; with more, none is
[[nodiscard]] MotionErrors motion_errors(const MarkerMotion& recorded,
                                         const Eigen::Matrix3Xd& residuals, double length,
                                         std::size_t listed = most_markers);

}  // namespace dlo::compare
