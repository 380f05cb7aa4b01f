#pragma once

#include <Eigen/Core>
#include <vector>

#include "recording/model_motion.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// One frame of a recording beside the rod.
struct FrameError {
  double time = 0;          ///< [s]
  double rms_m = 0;         ///< of its points [m]
  double largest_m = 0;     ///< of a point [m]
  double largest_at_m = 0;  ///< arc length of that point [m]
};

/// A part of the rod, or a marker on it, in all frames.
struct PartError {
  double from_m = 0;     ///< arc length where it begins [m]
  double to_m = 0;       ///< and ends; of a marker the same [m]
  double rms_m = 0;      ///< of its points [m]
  double largest_m = 0;  ///< of a point [m]
};

/// How far a recording is from a rod.
struct MotionErrors {
  double rms_m = 0;                ///< of all points [m]
  double largest_m = 0;            ///< of a point [m]
  std::vector<FrameError> frames;  ///< by time
  std::size_t worst_frame = 0;     ///< that with the largest RMS
  std::vector<PartError> thirds;   ///< of the rod, that have points
  std::vector<PartError> markers;  ///< by arc length; none where there are too many
};

/// Frames of a simulator have as many points as they like.
inline constexpr std::size_t most_markers = 30;

/// Recorded less the rod's points [m], 3 x positions.
/// @param lag  by which the recording is late: the rod's points are those at time - lag [s]
[[nodiscard]] Eigen::Matrix3Xd motion_residuals(const MarkerMotion& recorded,
                                                const ModelMotion& model, double lag = 0);

/// Root of the mean square of columns [m].
[[nodiscard]] double rms_of(const Eigen::Matrix3Xd& residuals);

/// @param length  of the rod [m]
/// @param listed  markers, of which a recording with more has none in the list
[[nodiscard]] MotionErrors motion_errors(const MarkerMotion& recorded,
                                         const Eigen::Matrix3Xd& residuals, double length,
                                         std::size_t listed = most_markers);

}  // namespace dlo::compare
