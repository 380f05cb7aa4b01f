#pragma once

#include <Eigen/Core>
#include <optional>

#include "recording/model_motion.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// What a recording may be off as a whole, beside its lag.
enum class Displacement { none, constant };

/// A constant shift of a recording in time, and in space.
struct MotionShift {
  double lag = 0;                                    ///< by which the recording is late [s]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< by which it is displaced [m]
  double rms_m = 0;                                  ///< that is left [m]
};

/// How far a lag is looked for, to either side: a quarter of the recording's duration.
inline constexpr double lag_range_share = 0.25;

/// The mean displacement.
[[nodiscard]] MotionShift best_offset(const MarkerMotion& recorded, const ModelMotion& model);

/// The shift with the least mean square distance of all points.
/// @param earliest  before which the rod is not known [s]; points whose shifted time may be before
/// it are left out
/// @return nothing if the least one is at an end of the range
[[nodiscard]] std::optional<MotionShift> best_lag(const MarkerMotion& recorded,
                                                  const ModelMotion& model, double earliest,
                                                  Displacement displacement);

}  // namespace dlo::compare
