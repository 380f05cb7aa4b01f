#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Shapes of a rod at equal steps of time and of arc length, interpolated by cubics (Lagrange's,
/// through the four nearest values) in both. Before the first and after the last frame the shape is
/// constant.
class ModelMotion {
 public:
  /// @param begin, end  times of the first and the last frame [s]
  /// @param length      of the rod, on which the points have equal distances [m]
  /// @param frames      points [m], 3 x M each; M and the number of frames are at least four
  ModelMotion(double begin, double end, double length, std::vector<Eigen::Matrix3Xd> frames);

  [[nodiscard]] double begin() const { return begin_; }  ///< time of the first frame [s]
  [[nodiscard]] double end() const { return end_; }      ///< time of the last frame [s]
  /// Returns the rod's point at a time and an arc length [m].
  [[nodiscard]] Eigen::Vector3d at(double time, double arc_length) const;

 private:
  double begin_, end_, length_;
  std::vector<Eigen::Matrix3Xd> frames_;
};

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

/// Times of a recording.
struct RecordedTimes {
  int count = 0;               ///< number of different times
  double first = 0, last = 0;  ///< [s]
};

/// Returns the times of a recording, which is in the order of time.
/// @param length  of the rod [m]
/// @throws InputError if a point is not on the rod
[[nodiscard]] RecordedTimes recorded_times(const MarkerMotion& recorded, double length);

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

/// Displacement of a whole recording that is fitted besides its lag.
enum class Displacement { none, constant };

/// A constant shift of a recording in time and in space.
struct MotionShift {
  double lag = 0;                                    ///< delay of the recording [s]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< displacement of the recording [m]
  double rms_m = 0;            ///< remaining RMS distance of the points that were used [m]
  double unshifted_rms_m = 0;  ///< RMS distance of the same points without lag and offset [m]
};

/// Describes a lag: "it is 30 ms late".
[[nodiscard]] std::string lag_words(const MotionShift& shift);

/// Largest lag that is tried, in both directions, divided by the recording's duration.
inline constexpr double lag_range_share = 0.25;

/// Returns the mean displacement without a lag.
[[nodiscard]] MotionShift best_offset(const MarkerMotion& recorded, const ModelMotion& model);

/// Returns the shift with the least mean square distance of the points. Of more than 20000 points
/// it uses every n-th time only.
/// @param earliest  time before which the rod is not known [s]; points whose shifted time may be
/// earlier are omitted
/// @return std::nullopt if the least distance is at an end of the range, fewer than eight points
/// are left, the recording has one time, or the model ends no later than the recording
[[nodiscard]] std::optional<MotionShift> best_lag(const MarkerMotion& recorded,
                                                  const ModelMotion& model, double earliest,
                                                  Displacement displacement);

}  // namespace dlo::compare
