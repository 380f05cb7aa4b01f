#pragma once

#include <Eigen/Core>
#include <optional>

#include "recording/model_motion.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Displacement of a whole recording that is fitted besides its lag.
enum class Displacement { none, constant };

/// A constant shift of a recording in time and in space.
struct MotionShift {
  double lag = 0;                                    ///< delay of the recording [s]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< displacement of the recording [m]
  double rms_m = 0;                                  ///< remaining RMS distance [m]
};

/// Largest lag that is tried, in both directions, divided by the recording's duration.
inline constexpr double lag_range_share = 0.25;

/// Returns the mean displacement without a lag.
[[nodiscard]] MotionShift best_offset(const MarkerMotion& recorded, const ModelMotion& model);

/// Returns the shift with the least mean square distance of all points.
/// @param earliest  time before which the rod is not known [s]; points whose shifted time may be
/// earlier are omitted
/// @return std::nullopt if the least distance is at an end of the range, or fewer than eight points
/// are left
[[nodiscard]] std::optional<MotionShift> best_lag(const MarkerMotion& recorded,
                                                  const ModelMotion& model, double earliest,
                                                  Displacement displacement);

}  // namespace dlo::compare
