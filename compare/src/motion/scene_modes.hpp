#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/energy_model/vibrations.hpp"

namespace dlo::compare {

/// Largest number of points of a polygon whose modes are computed, by dense matrices.
inline constexpr int most_points_of_modes = 300;

/// The force model's polygon at rest, with its masses and stiffness.
struct MovingPolygon {
  Discretisation discretisation;
  Eigen::Matrix3Xd points;         ///< positions at rest [m]
  std::vector<Eigen::Index> free;  ///< indices of the points that move
  Eigen::VectorXd masses;          ///< masses of the points that move, with what hangs on them [kg]
  /// Stiffness matrix of the points that move; x, y, z of each in turn [N/m].
  Eigen::MatrixXd stiffness;
};

/// Computes the polygon at rest.
/// @throws InputError if the scene has no such polygon, ConvergenceError if it is not stable at
/// rest
[[nodiscard]] MovingPolygon polygon_at_rest(const Scene& scene, const SolveOptions& options);

/// Vibration modes of points on springs: K v = square M v.
struct PolygonModes {
  Eigen::VectorXd masses;               ///< by point
  Eigen::VectorXd squared_frequencies;  ///< squared angular frequencies, growing [1/s^2]
  Eigen::MatrixXd shapes;               ///< modes as columns, v^T M v = 1

  /// Mode, or modes of one frequency together, most similar to a given displacement.
  struct Match {
    double omega_squared = 0;
    double kinetic_share = 0;  ///< their share of the kinetic energy of the displacement [-]
  };
  /// Finds the modes most similar to a displacement.
  /// @param movement  displacement, in the order of the stiffness matrix
  [[nodiscard]] Match nearest(const Eigen::VectorXd& movement) const;
};

/// Computes the modes. @param masses  > 0 [kg]
[[nodiscard]] PolygonModes polygon_modes(const Eigen::MatrixXd& stiffness,
                                         const Eigen::VectorXd& masses);

/// Options of scene_modes(): the number of modes, and the steps of the force model.
struct ModeOptions {
  int count = 6;          ///< modes, > 0
  double rate = 4000;     ///< steps a second, > 0 (the paper's)
  double damping = 0.01;  ///< damping ratio of the slowest mode in the material [-], > 0 to 1
  /// Tension of a rod that clamps hold straight, which its shape does not determine [N]; empty: 0.
  std::optional<double> tension = std::nullopt;
  SolveOptions solve;  ///< limits of the solvers
};

/// Motion of a mode with stiffness k under the stepper's c_F and c_h, exactly: z^2 - (1 + c_h - c_F
/// k) z + c_h = 0 from one step to the next (Formula 19).
struct SteppedMode {
  double omega = 0;        ///< [rad/s]; 0 if both z are real
  double damping = 1;      ///< damping ratio [-]; 1 if both z are real
  bool is_stable = false;  ///< whether both |z| are at most 1
};

/// Computes the motion of a mode. @param rate  steps per second
[[nodiscard]] SteppedMode stepped_mode(double stiffness, double c_F, double c_h, double rate);

/// One mode of the rod, and the corresponding modes of the polygon and of the stepper.
struct SceneMode {
  energy_model::VibrationMode rod;
  std::optional<double> polygon_omega;  ///< frequency of the polygon with the rod's masses [rad/s]
  double polygon_kinetic_share = 0;     ///< see PolygonModes::Match::kinetic_share [-]
  std::optional<SteppedMode> stepped;   ///< with the scene's c_F and c_h; only stepper `dynamic`
};

/// Step constants with which each point has the mean mass of the rod's points, and the damping is
/// that of the material.
struct PhysicalSteps {
  double point_mass = 0;  ///< mean of the free points [kg]
  double c_F = 0;         ///< 1 / (rate^2 point_mass) [m/N]
  double c_h = 1;         ///< exp(-2 zeta omega / rate) of the slowest mode [-]
  /// Steps per second below which these masses are unstable, without regard to c_s.
  double least_rate = 0;
};

/// The slowest modes of a scene's rod, of its polygon, and of the stepping force model.
struct SceneModes {
  energy_model::SolveStatus status = energy_model::SolveStatus::not_run;  ///< rod's modes
  std::string message;
  std::vector<SceneMode> modes;                ///< the slowest first
  std::optional<double> tension;               ///< tension of a rod that clamps hold straight [N]
  std::string missing_polygon_reason;          ///< why the polygon has no modes; empty if it has
  std::optional<double> effective_point_mass;  ///< m* = dt^2 / c_F; only `dynamic` [kg]
  std::optional<PhysicalSteps> physical;
};

/// Computes the modes about the equilibrium that the energy model finds, for small displacements;
/// obstacles and grips are fixed.
/// @throws InputError, ConvergenceError; also if the rod touches a rigid obstacle
[[nodiscard]] SceneModes scene_modes(const Scene& scene, const ModeOptions& options = {});

}  // namespace dlo::compare
