#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "recording/model_motion.hpp"
#include "suite/battery.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {

/// Why a simulator's shapes are not the rod's.
struct Cause {
  std::string name;    ///< the same for all scenes: "first element welded"
  double factor = 0;   ///< its size; NaN: it has none
  std::string words;   ///< a clause, with numbers
  bool defect = true;  ///< the shapes do not converge to the rod because of it
};

/// A simulator's shape of a scene with so many points.
struct CardShape {
  int points = 0;    ///< N
  Shape shape;       ///< in the scene's frame, along the whole rod
  double error = 0;  ///< RMS over length [-]
};

/// How an error falls with the number of points: p of e ~ N^-p, from the first shape to the last;
/// NaN where there are less than two or an error is below what the reference itself is off.
[[nodiscard]] double convergence_order(const std::vector<CardShape>& shapes);

/// An error that is none, as a share of the length.
inline constexpr double error_floor = 1e-7;

/// Names what is wrong with shapes that do not converge to the rod with second order, as far as it
/// can be told: a cause is named if it leaves little of the error. Of shapes that do
/// converge only springs that are linear in the angle are named, where that shows.
/// @param reference  the scene's equilibrium
/// @param shapes     by growing N, at least one
[[nodiscard]] std::vector<Cause> causes_of(const Scene& scene,
                                           const energy_model::Equilibrium& reference,
                                           const std::vector<CardShape>& shapes,
                                           const SolveOptions& options = {});

/// The bending stiffness that fits a shape with so many points best.
struct StiffnessFactor {
  int points = 0;     ///< N
  double factor = 0;  ///< over the scene's [-], > 0
};

/// What a stiffness is that depends on the number of points, or does not: a power of the element's
/// length, or a weight to which each element's ends add, as those of capsules do.
/// @param coarse, fine  of the smallest and the largest N
[[nodiscard]] Cause cause_of_factors(const Scene& scene, const StiffnessFactor& coarse,
                                     const StiffnessFactor& fine);

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
