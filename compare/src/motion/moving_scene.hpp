#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "motion/frame_clock.hpp"
#include "motion/motion_start.hpp"

namespace dlo::compare {

/// What takes energy from a moving rod.
struct RodDamping {
  double material = 0;   ///< tau of Kelvin-Voigt, M = EI (kappa + tau kappa') [s], >= 0
  double air = 0;        ///< force per length and velocity [N s/m^2], >= 0
  double quadratic = 0;  ///< the same across the rod, and squared velocity [N s^2/m^3], >= 0
};

/// Fewer terms, which nobody asked for, with which the integrator gave up.
struct TooFewTerms {
  int terms = 0;
  double time = 0;  ///< of the first frame that it did not come to [s]
};

/// A simulation of a scene's rod.
struct SimulatedMotion {
  energy_model::Dynamics moved;
  std::optional<TooFewTerms> too_few_terms;
  double seconds = 0;  ///< what it took, without what too few terms took

  /// Why it ended early, with what lets it go on.
  [[nodiscard]] std::string why_stopped() const;
};

/// @throws InputError if the scene has what a rod with inertia cannot have here: clamps that hold
/// its frame and change their direction, couples, drag of a stream, no mass
void require_dynamic(const Scene& scene);

/// Tolerance of one step of a simulation, as DynamicsOptions::tolerance.
inline constexpr double usual_step_tolerance = 1e-7;

/// A scene's rod at the first frame of its motion, with its masses and the ways of its grips and
/// obstacles: as a given start has it, or in equilibrium at rest, or where grips and obstacles move
/// in motion as its equilibria follow them.
class MovingScene {
 public:
  /// @throws InputError as require_dynamic(), and if the damping is out of range; ConvergenceError
  /// if there is no shape to begin with
  MovingScene(const Scene& scene, const FrameClock& clock, const RodDamping& damping,
              const SolveOptions& solve, std::optional<MotionStart> start = {});

  /// The scene's obstacles that are ever in reach.
  [[nodiscard]] const std::vector<std::size_t>& obstacles() const { return obstacles_; }
  [[nodiscard]] bool in_motion() const { return in_motion_; }
  /// @param times  growing, of the scene [s];  @param terms  0: those that it needs
  [[nodiscard]] SimulatedMotion run(const std::vector<double>& times, int terms,
                                    double tolerance = usual_step_tolerance) const;

 private:
  std::string file_;
  double begin_ = 0;
  double time_limit_ = 0;
  std::vector<std::size_t> obstacles_;
  energy_model::MovingRod rod_;
  MotionStart start_;
  bool in_motion_ = false;
};

}  // namespace dlo::compare
