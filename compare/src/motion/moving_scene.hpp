#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/trajectory.hpp"
#include "dlo/energy_model/dynamics.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/grip_motion.hpp"
#include "dlo/energy_model/vibrations.hpp"
#include "motion/frame_clock.hpp"
#include "motion/motion_start.hpp"

namespace dlo::compare {

/// Returns the masses of a scene's rod, of its sections and of what hangs on it.
[[nodiscard]] energy_model::Inertia scene_inertia(const Scene& scene);

/// Returns the motion of a gripper along a trajectory. Time 0 of the motion is `begin` [s]. The
/// rotation is relative to the pose at `begin`; directions follow great circles. Accelerations jump
/// at a pose: at the time of the pose, up to rounding, they are those of the leg before it, and
/// later those of the leg after it.
/// @param trajectory   trajectory with poses
/// @param rolls_about  direction at `begin` of a clamp that holds the rod's frame; empty for any
/// other gripper, for which rolls have no effect
[[nodiscard]] energy_model::GripMotion trajectory_motion(
    const Trajectory& trajectory, double begin,
    const std::optional<Eigen::Vector3d>& rolls_about = std::nullopt);

/// Returns the times of the poses relative to `begin` [s]: MovingRod::breaks.
[[nodiscard]] std::vector<double> trajectory_breaks(const Trajectory& trajectory, double begin);

/// Damping of a moving rod.
struct RodDamping {
  double material = 0;   ///< tau of Kelvin-Voigt, M = EI (kappa + tau kappa') [s], >= 0
  double air = 0;        ///< force per length and velocity [N s/m^2], >= 0
  double quadratic = 0;  ///< force across the rod per length and squared velocity [N s^2/m^3], >= 0
};

/// A default number of terms with which the integrator failed.
struct TooFewTerms {
  int terms = 0;
  double time = 0;  ///< time of the first frame that the integrator did not reach [s]
};

/// A simulation of a scene's rod.
struct SimulatedMotion {
  energy_model::Dynamics moved;
  std::optional<TooFewTerms> too_few_terms;
  double seconds = 0;  ///< duration of the computation [s], without the runs with too few terms

  /// Returns why the simulation ended early, and how it can continue.
  [[nodiscard]] std::string stop_reason() const;
};

/// Checks that a rod with inertia can be simulated.
/// @throws InputError for loads without a potential, couples, tangential drag, or no mass; also if
/// a clamp that holds the frame of a twisted rod, or of one with directors, changes its direction
void require_dynamic(const Scene& scene);

/// Default tolerance of one step of a simulation, see DynamicsOptions::tolerance.
inline constexpr double usual_step_tolerance = 1e-7;

/// A scene's rod at the first frame of its motion, with its masses and the motions of its grips and
/// obstacles. It starts with a given shape and velocities, or in equilibrium; if grips or obstacles
/// move then, it has the velocities with which its equilibria follow them.
class MovingScene {
 public:
  /// @throws InputError as require_dynamic(), and if the energy model rejects the scene;
  /// ConvergenceError if there is no initial shape
  MovingScene(const Scene& scene, const FrameClock& clock, const RodDamping& damping,
              const SolveOptions& solve, std::optional<MotionStart> start = {});

  /// Returns the indices of the scene's obstacles that are in reach at any time.
  [[nodiscard]] const std::vector<std::size_t>& obstacles() const { return obstacles_; }
  [[nodiscard]] bool in_motion() const { return in_motion_; }
  /// Simulates the rod.
  /// @param times  growing, of the scene [s]
  /// @param terms  0: 12, or up to 32 if the integration fails with fewer
  /// @throws InputError if the damping is out of range
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
