#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/vibrations.hpp"

namespace dlo::compare {

/// How many modes, and how a force model would step.
struct ModeOptions {
  int count = 6;          ///< modes, > 0
  double rate = 4000;     ///< steps a second, > 0 (the paper's)
  double damping = 0.01;  ///< ratio of the slowest mode that the material has [-], > 0 to 1
  /// Of a rod that clamps hold straight, not identifiable from its shape [N]; none: 0.
  std::optional<double> tension = std::nullopt;
  SolveOptions solve;  ///< limits of the solvers
};

/// What the stepper's c_F and c_h make of a movement of stiffness k, exactly:
/// z^2 - (1 + c_h - c_F k) z + c_h = 0 from one step to the next (Formula 19).
struct SteppedMode {
  double omega = 0;        ///< [rad/s]; 0 where it is overdamped
  double damping = 1;      ///< ratio [-]; 1 where it is overdamped
  bool is_stable = false;  ///< both |z| are at most 1
};

/// @param rate  steps a second
[[nodiscard]] SteppedMode stepped_mode(double stiffness, double c_F, double c_h, double rate);

/// One mode of the rod, and what becomes of it.
struct SceneMode {
  energy_model::VibrationMode rod;
  std::optional<double> polygon_omega;  ///< of the points with the rod's masses [rad/s]
  double polygon_likeness = 0;          ///< how much its movement is the rod's [-]
  std::optional<SteppedMode> stepped;   ///< by the scene's own c_F and c_h
};

/// What would make the mass of each point that of the rod's points in the mean, and the damping
/// that of the material.
struct PhysicalSteps {
  double point_mass = 0;  ///< mean of the free points [kg]
  double c_F = 0;         ///< 1 / (rate^2 point_mass) [m/N]
  double c_h = 1;         ///< [-]
  /// Steps a second below which these masses are unstable, but for what c_s then does.
  double least_rate = 0;
};

/// The slowest modes of a scene's rod, of its polygon, and of the force model as it steps.
struct SceneModes {
  energy_model::SolveStatus status = energy_model::SolveStatus::not_run;  ///< of the rod's
  std::string message;
  std::vector<SceneMode> modes;         ///< the slowest first
  std::optional<double> tension;        ///< of a rod that clamps hold straight [N]
  std::string no_polygon;               ///< why there are none of the polygon; empty: there are
  std::optional<double> mass_of_steps;  ///< m* = dt^2 / c_F of the scene's stepper [kg]
  std::optional<PhysicalSteps> physical;
};

/// About the equilibrium that the energy model finds, for small movements: obstacles and grips
/// stand. @throws InputError, ConvergenceError; that too if the rod touches a rigid obstacle
[[nodiscard]] SceneModes scene_modes(const Scene& scene, const ModeOptions& options = {});

}  // namespace dlo::compare
