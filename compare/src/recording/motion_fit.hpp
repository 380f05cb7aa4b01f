#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "motion/moving_scene.hpp"
#include "recording/motion_residuals.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Numbers to fit to a recorded motion, and limits.
struct MotionFitOptions {
  RodDamping damping;  ///< known damping, where it is not fitted
  bool material = true;
  bool air = true;
  bool quadratic = true;
  SolveOptions solve;  ///< limits of each simulation
};

/// A number fitted to a recorded motion, with its 95 % interval.
struct MotionNumber {
  double value = 0;
  double low = 0;
  double high = 0;
  bool identified = true;  ///< whether the interval is narrower than a factor of 100
};

/// A recording to which a moving rod was fitted, with its distances.
struct FittedRecording {
  std::string file;
  MotionErrors errors;  ///< distances between markers and rod
  /// Whether the rod starts with a fitted shape and velocities; otherwise it starts in equilibrium,
  /// because the markers are too few.
  bool starts_as_recorded = false;
};

/// Result of a fit of a moving rod to recordings.
struct MotionFit {
  std::vector<FittedRecording> recordings;
  int terms = 0;
  /// Why the stiffness is not identified; empty if it is.
  std::string not_identified;
  MotionNumber stiffness;        ///< EI / (rho A), outside sections [m^4/s^2]
  MotionNumber scene_stiffness;  ///< Scene::stiffness() for the scene's mass
  std::optional<MotionNumber> material, air, quadratic;  ///< see RodDamping, for the scene's mass
  RodDamping damping;                                    ///< the whole damping, fitted and known
  double noise = 0;  ///< standard deviation of a coordinate, from the residuals [m]
  double rms = 0;    ///< RMS distance between markers and rod [m]
  /// RMS distance of the scene as given, with fitted starts [m]; not meaningful if its simulation
  /// ends early.
  double given_rms = 0;
  std::size_t coordinates = 0;
  /// Number of independent coordinates with the same information: the residuals of a marker are
  /// correlated in time.
  double effective_coordinates = 0;
  std::vector<PartError> by_marker;  ///< in the order of arc length
  int simulations = 0;
};

/// Fits the stiffness per mass and the damping of the rod, so that its simulation is nearest to
/// recordings of markers on it (least squares of their coordinates over the logarithms of the
/// numbers). The rod starts at the first time of a recording with a shape and velocities that are
/// fitted as well (MotionMisfit). A first window is fitted first, then windows that grow up to the
/// whole recording.
/// @param scene   its grippers have the trajectories that moved them
/// @param stages  called before each simulation
/// @throws InputError if the scene cannot move like this, a recording does not belong to it or has
/// too few rows, or the rod does not move at the markers; ConvergenceError if a simulation from
/// which the fit of a window starts ends early
[[nodiscard]] MotionFit fit_motion(const Scene& scene, const std::vector<MarkerMotion>& recordings,
                                   const MotionFitOptions& options, const Stages& stages = {});

}  // namespace dlo::compare
