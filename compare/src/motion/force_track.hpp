#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/equilibrium.hpp"

namespace dlo::compare {

/// Whether the force model makes its steps beside the energy model.
enum class ForceBeside { runs, absent };

/// The force model at the end of a frame.
struct ForceFrame {
  double error_over_length = 0;       ///< RMS distance from the energy model's shape [-]
  std::vector<GripperLoad> grippers;  ///< what each exerts on the rod
  Eigen::Matrix3Xd points;  ///< at the track's arc lengths, between its points straight [m]
  Shape shape;              ///< its own points [m]
};

/// What the force model's frames come to.
struct ForceTrackSummary {
  std::string none;           ///< why there are no frames; empty: there are
  long steps_per_frame = 0;   ///< of the stepper
  double rest_error = 0;      ///< of the first frame, at rest: no lag is in it, over the length [-]
  double largest = 0;         ///< error over the length [-]
  double largest_time = 0;    ///< [s]
  double mean = 0;            ///< of the errors over the length [-]
  double median_seconds = 0;  ///< of a frame's steps
  /// Lag of its shapes: the shift of time that brings them nearest to the energy
  /// model's, and the RMS over all frames that is left then, over the length. NaN where nothing
  /// moves enough to tell.
  double lag = std::numeric_limits<double>::quiet_NaN();  ///< [s], >= 0
  double error_without_lag = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> neglected;  ///< as Solution::neglected
};

/// A scene's force model in simulated time, at rest at first.
class ForceTrack {
 public:
  /// @param now        the scene at the first frame, standing
  /// @param rod        its shape
  /// @param obstacles  of the scene, that are in reach at any time
  /// @throws InputError if the scene is none for the force model
  /// @throws ConvergenceError if it does not come to rest
  ForceTrack(const Scene& now, const energy_model::Equilibrium& rod,
             const std::vector<std::size_t>& obstacles, const SolveOptions& options);
  ~ForceTrack();
  ForceTrack(const ForceTrack&) = delete;
  ForceTrack& operator=(const ForceTrack&) = delete;

  /// The steps of a frame.
  /// @param now  the scene at its end, standing
  /// @return whether no step diverged
  [[nodiscard]] bool step(const Scene& now, long steps);
  /// As it is. @param arc_length  of the points [m]
  [[nodiscard]] ForceFrame frame(const energy_model::Equilibrium& rod,
                                 const std::vector<double>& arc_length) const;
  /// What the last step() took [s].
  [[nodiscard]] double seconds() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The shift of time by which a series of shapes lags behind another one.
struct Lag {
  double time = std::numeric_limits<double>::quiet_NaN();  ///< [s], >= 0
  double rms = std::numeric_limits<double>::quiet_NaN();   ///< that is left [m]
};

/// The lag at which the mean square distance over all frames is least; before its first frame the
/// leader stands. NaN if the leader does not move, or is nearest where it stands all the time, as
/// to a follower that goes elsewhere.
/// @param leader, follower  shapes at equal steps of time [m], as many of each
/// @param step              of time [s]
[[nodiscard]] Lag lag_of(const std::vector<Eigen::Matrix3Xd>& leader,
                         const std::vector<Eigen::Matrix3Xd>& follower, double step);

}  // namespace dlo::compare
