#pragma once

#include <vector>

#include "dlo/compare/solve.hpp"
#include "recording/model_motion.hpp"
#include "suite/battery.hpp"
#include "suite/cause.hpp"
#include "trajectory/read_markers.hpp"

namespace dlo::compare {

/// What a simulator's motion is held against.
struct MotionReference {
  ModelMotion motion;   ///< of the energy model, beyond `until`
  double length = 0;    ///< of the rod [m]
  double until = 0;     ///< [s]
  int frames = 0;       ///< that are asked for
  double travel = 0;    ///< RMS distance of its points from where they begin, of these frames [m]
  ModelMotion at_rest;  ///< the scene's equilibrium, at all times
};

/// Of a scene that has a motion. @throws InputError, ConvergenceError as release_rod()
[[nodiscard]] MotionReference motion_reference(const BatteryScene& scene,
                                               const SolveOptions& options = {});

/// RMS distance of all its points, at their own times and arc lengths, over the reference's travel.
/// @throws InputError if it leaves the rod or the time, has less than half of the frames, or none
/// near the first and the last time
[[nodiscard]] double motion_error(const MotionReference& reference, const MarkerMotion& recorded);

/// What is wrong with a motion, as far as it leaves little of its error: it stays where it begins,
/// follows without inertia, is late or early, has another frequency, or is damped.
/// @return one, or none
[[nodiscard]] std::vector<Cause> motion_causes(const MotionReference& reference,
                                               const MarkerMotion& recorded);

}  // namespace dlo::compare
