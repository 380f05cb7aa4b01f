#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/progress.hpp"
#include "dlo/compare/scene.hpp"
#include "motion/moving_scene.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// What is found from a recorded motion.
struct MotionFitOptions {
  RodDamping damping;  ///< what is known of it, where it is not fitted
  bool material = true;
  bool air = true;
  bool quadratic = true;
  SolveOptions solve;  ///< limits of each simulation
};

/// A number from a recorded motion, with its interval of 95 %.
struct MotionNumber {
  double value = 0;
  double low = 0;
  double high = 0;
  bool identified = true;  ///< whether the interval is narrower than a factor of 100
};

/// One marker of a recorded motion.
struct MarkerError {
  double at = 0;   ///< arc length [m]
  double rms = 0;  ///< distance from the moving rod [m]
};

/// Recording to which a moving rod was fitted.
struct FittedRecording {
  std::string file;
  std::size_t times = 0;
  double from = 0, to = 0;  ///< [s]
  double rms = 0;           ///< distance of markers and rod [m]
  double worst_time = 0;    ///< time at which it is largest [s]
  double worst_rms = 0;     ///< distance at that time [m]
  /// Whether the rod starts with a shape and velocities that are fitted; else it starts in
  /// equilibrium, because the markers are too few.
  bool starts_as_recorded = false;
};

/// Result of a fit of a moving rod to recordings.
struct MotionFit {
  std::vector<FittedRecording> recordings;
  int terms = 0;
  /// Why the stiffness is not identified; empty: it is.
  std::string not_identified;
  MotionNumber stiffness;        ///< EI / (rho A), outside sections [m^4/s^2]
  MotionNumber scene_stiffness;  ///< Scene::stiffness() that goes with the scene's mass
  std::optional<MotionNumber> material, air, quadratic;  ///< as RodDamping's, of the scene's mass
  RodDamping damping;                                    ///< all of it, fitted and known
  double noise = 0;      ///< of a coordinate, estimated from the residuals [m]
  double rms = 0;        ///< distance of markers and rod [m]
  double given_rms = 0;  ///< the same of the scene as it was given [m]
  std::size_t coordinates = 0;
  /// So many independent ones know as much: the residuals of a marker are correlated in time.
  double effective_coordinates = 0;
  std::vector<MarkerError> by_marker;  ///< by arc length
  int simulations = 0;
};

/// Finds stiffness over mass and damping of the rod, whose simulation comes nearest to recordings
/// of markers on it (least squares of their coordinates over the logarithms of the numbers). The
/// rod starts at the first time of a recording with a shape and velocities that are fitted as well
/// (MotionMisfit). A first window is fitted first, then twice as much, up to all.
/// @param scene   whose grippers have the trajectories that moved them
/// @param stages  called before each simulation
/// @throws InputError if the scene cannot move so, or a recording is not of it; ConvergenceError
/// if no simulation comes to its end
[[nodiscard]] MotionFit fit_motion(const Scene& scene, const std::vector<MarkerMotion>& recordings,
                                   const MotionFitOptions& options, const Stages& stages = {});

}  // namespace dlo::compare
