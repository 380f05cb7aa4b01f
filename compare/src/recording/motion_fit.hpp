#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "motion/moving_scene.hpp"
#include "trajectory/read_markers.hpp"

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
};

/// One marker, or one time, of a recorded motion.
struct MarkerError {
  double at = 0;   ///< arc length [m], or time [s]
  double rms = 0;  ///< distance from the moving rod [m]
};

/// A moving rod beside its recording.
struct MotionFit {
  std::string file;
  std::size_t times = 0, markers = 0;
  double from = 0, to = 0;  ///< [s]
  bool in_motion = false;   ///< as DynamicTrack's
  int terms = 0;
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
  MarkerError worst;                   ///< of the times
  int simulations = 0;
};

/// Stiffness over mass and damping of the rod, whose simulation comes nearest to a recording of
/// markers on it (least squares of their coordinates, by GSL's trust region). The rod begins at the
/// first time of the recording, in motion as its shapes at rest follow the grips.
/// @param scene  whose grippers have the trajectories that moved them
/// @throws InputError if the scene cannot move so, or the recording is not of it; ConvergenceError
/// if no simulation comes to its end
[[nodiscard]] MotionFit fit_motion(const Scene& scene, const MarkerMotion& recorded,
                                   const MotionFitOptions& options);

}  // namespace dlo::compare
