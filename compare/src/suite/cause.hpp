#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "recording/motion_residuals.hpp"
#include "suite/battery.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Cause of the difference between a simulator's shapes and the rod's.
struct Cause {
  std::string name;    ///< name, equal for all scenes, such as "first element welded"
  double factor = 0;   ///< magnitude of the cause; NaN if it has none
  std::string words;   ///< clause with numbers
  bool defect = true;  ///< whether the shapes do not converge to the rod because of the cause
};

/// Shape of a scene by a simulator, with N points.
struct CardShape {
  int points = 0;  ///< N
  Shape shape;     ///< shape of the whole rod, in the scene's frame
  /// RMS distance from the reference, divided by the length; for a motion, motion_error() [-].
  double error = 0;
};

/// Returns the order of convergence: p of e ~ N^-p, from the first shape to the last; NaN if there
/// are fewer than two shapes, or if an error is at most error_floor.
[[nodiscard]] double convergence_order(const std::vector<CardShape>& shapes);

/// Error that is indistinguishable from the reference's own error, divided by the length.
inline constexpr double error_floor = 1e-7;

/// Identifies causes of the error of shapes that do not converge to the rod with second order. A
/// cause is accepted if it leaves only a small fraction of the error. For shapes that converge, the
/// only possible cause is springs that are linear in the angle, if the difference is observable.
/// @param reference  equilibrium of the scene
/// @param shapes     in the order of N, at least one
[[nodiscard]] std::vector<Cause> causes_of(const Scene& scene,
                                           const energy_model::Equilibrium& reference,
                                           const std::vector<CardShape>& shapes);

/// Bending stiffness that fits a shape with N points best.
struct StiffnessFactor {
  int points = 0;     ///< N
  double factor = 0;  ///< divided by the scene's stiffness [-], > 0
};

/// Returns the cause that explains how the fitted stiffness depends on the number of points: a
/// constant factor, a power of the element's length, or a weight that increases with the number of
/// elements, as that of capsules does.
/// @param coarse, fine  of the smallest and the largest N
[[nodiscard]] Cause cause_of_factors(const Scene& scene, const StiffnessFactor& coarse,
                                     const StiffnessFactor& fine);

/// Reference with which a simulator's motion is compared.
struct MotionReference {
  ModelMotion motion;   ///< motion by the energy model, longer than `end_time`
  double length = 0;    ///< length of the rod [m]
  double end_time = 0;  ///< end time of the scene [s]
  int frames = 0;       ///< number of requested frames
  /// RMS distance of its points from their positions at time 0, over the requested frames [m].
  double rms_displacement = 0;
  ModelMotion at_rest;  ///< equilibrium of the scene, as a motion
};

/// Computes the reference of a scene that has a motion. @throws InputError, ConvergenceError as
/// release_rod()
[[nodiscard]] MotionReference motion_reference(const BatteryScene& scene);

/// Returns the RMS distance of all recorded points from the reference at their times and arc
/// lengths, divided by MotionReference::rms_displacement. @throws InputError if a point is not on
/// the rod, a time is out of range, fewer than half of the frames exist, or none is near the first
/// or the last time
[[nodiscard]] double motion_error(const MotionReference& reference, const MarkerMotion& recorded);

/// Identifies the cause of a motion's error, if one leaves only a small fraction of it: the rod
/// does not move, follows without inertia, is late or early, has another frequency, or is damped.
/// @return one cause or none
[[nodiscard]] std::vector<Cause> motion_causes(const MotionReference& reference,
                                               const MarkerMotion& recorded);

}  // namespace dlo::compare
