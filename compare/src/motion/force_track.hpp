#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/force_model/simulation.hpp"

namespace dlo::compare {

/// Whether the force model is simulated besides the energy model.
enum class ForceModelRun { runs, absent };

/// State of the force model at the end of a frame.
struct ForceFrame {
  double error_over_length = 0;       ///< RMS distance from the energy model's shape [-]
  std::vector<GripperLoad> grippers;  ///< force and torque of each gripper on the rod
  Eigen::Matrix3Xd points;  ///< positions at the track's arc lengths, interpolated linearly [m]
  Shape shape;              ///< points of the force model's polygon [m]
};

/// Mean and largest error over all frames.
struct TrackErrors {
  double mean = 0;          ///< divided by the length [-]
  double largest = 0;       ///< divided by the length [-]
  double largest_time = 0;  ///< time of the largest error [s]

  /// Adds an error; `mean` is the sum until it is divided by the number of errors.
  void add(double error, double time) {
    mean += error;
    if (!(error > largest)) return;
    largest = error;
    largest_time = time;
  }
};

/// Errors of the force model's shapes, which may lag behind those of another model.
struct ForceErrors : TrackErrors {
  /// Lag of the shapes: the shift of time that brings them nearest to the other model's, and the
  /// remaining RMS distance over all frames, over the length. NaN if the motion is too small.
  double lag = std::numeric_limits<double>::quiet_NaN();  ///< [s], >= 0
  double error_without_lag = std::numeric_limits<double>::quiet_NaN();

  /// Divides the sum of the errors by the number of frames, and sets the lag.
  /// @param leader, follower, step  as in estimate_lag();  @param length  of the rod [m]
  void finish(const std::vector<Eigen::Matrix3Xd>& leader,
              const std::vector<Eigen::Matrix3Xd>& follower, double step, double length);
};

/// Summary of the force model's frames, with their errors from the energy model.
struct ForceTrackSummary : ForceErrors {
  std::string missing_reason;  ///< why frames are missing; empty if none is
  long steps_per_frame = 0;    ///< 0 if the force model is not requested
  double rest_error = 0;  ///< error of the first frame, at rest without lag, over the length [-]
  double median_seconds = 0;  ///< median duration of a frame's steps [s]
};

/// The force model of a scene in simulated time; it starts at rest.
class ForceTrack {
 public:
  /// @param now        the scene at the first frame, without motion
  /// @param rod        shape of the rod in it
  /// @param obstacles  indices of the scene's obstacles that are in reach at any time
  /// @throws InputError if the force model does not support the scene
  /// @throws ConvergenceError if the force model does not come to rest
  ForceTrack(const Scene& now, const energy_model::Equilibrium& rod,
             const std::vector<std::size_t>& obstacles, const SolveOptions& options);

  /// Makes the steps of a frame.
  /// @param now  the scene at the end of the frame, without motion
  /// @return false if a step diverged
  /// @throws InputError if the force model does not support `now`
  [[nodiscard]] bool step(const Scene& now, long steps);
  /// Returns the current state. @param arc_length  of the points [m]
  [[nodiscard]] ForceFrame frame(const energy_model::Equilibrium& rod,
                                 const std::vector<double>& arc_length) const;
  /// Returns the duration of the last step() [s].
  [[nodiscard]] double seconds() const { return seconds_; }

 private:
  Discretisation discretisation_;
  std::vector<std::size_t> obstacles_;
  ForceModelSettings settings_;
  std::optional<force_model::Simulation> simulation_;
  double seconds_ = 0;
};

/// Shift of time by which a series of shapes lags behind another one.
struct Lag {
  double time = std::numeric_limits<double>::quiet_NaN();  ///< [s], >= 0
  double rms = std::numeric_limits<double>::quiet_NaN();   ///< remaining RMS distance [m]
};

/// Returns the lag with the least mean square distance over the frames, of 800 frames or more over
/// every n-th; before its first frame the leader is taken to rest. NaN if the leader does not move,
/// or if its first shape throughout is the best match, as for a follower that moves elsewhere.
/// @param leader, follower  shapes at equal time steps [m], the same number of each
/// @param step              time step [s]
[[nodiscard]] Lag estimate_lag(const std::vector<Eigen::Matrix3Xd>& leader,
                               const std::vector<Eigen::Matrix3Xd>& follower, double step);

}  // namespace dlo::compare
