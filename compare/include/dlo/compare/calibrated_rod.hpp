#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// How a gripper of all scenes is held beside what they say.
struct ClampCorrection {
  std::size_t gripper = 0;                                 ///< in the scene's order
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();      ///< of its direction, a vector [rad]
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< of its position [m]
};

/// What was found of a rod and of the fixture that holds it: what `dlo calibrate -o FILE.toml`
/// writes and `--calibrated FILE.toml` puts into scenes of the same rod in the same fixture.
struct CalibratedRod {
  /// As Scene::stiffness: E [Pa], or EI [N m^2] with `by_stiffness`.
  std::optional<double> stiffness;
  /// As Scene::heaviness: density [kg/m^3], or mass per length [kg/m] with `by_stiffness`.
  std::optional<double> heaviness;
  bool by_stiffness = false;                  ///< which of the two
  std::optional<double> torsional_stiffness;  ///< GJ [N m^2]
  /// Coefficients of P_0, P_1, .. about d1 and d2 [1/m]; empty: the scene's.
  std::vector<Eigen::Vector2d> natural_curvature;
  std::vector<ClampCorrection> clamps;  ///< of those that are held otherwise than scenes say
  /// Damping of the rod in motion: Kelvin-Voigt time of the material [s], drag of the air per
  /// length and velocity [N s/m^2], and drag across the rod per length and squared velocity [N
  /// s^2/m^3].
  std::optional<double> damping, drag, quadratic_drag;
  /// By what shapes are turned in the coordinates in which they were measured, about the first
  /// gripper, gravity with them: a rotation vector [rad].
  Eigen::Vector3d camera_tilt = Eigen::Vector3d::Zero();
};

/// A scene with that in the place of its own.
/// @throws InputError if the scene is given by E and that by EI or the reverse, or has not as many
/// grippers, or with `camera_tilt` if more than weight acts on its rod or something moves
[[nodiscard]] Scene calibrated_scene(Scene scene, const CalibratedRod& rod);

/// @throws InputError naming file, line, key and what is allowed
[[nodiscard]] CalibratedRod parse_calibrated_rod(const std::string& text, const std::string& file);
/// @throws InputError as parse_calibrated_rod(), or if the file cannot be read
[[nodiscard]] CalibratedRod load_calibrated_rod(const std::string& path);

}  // namespace dlo::compare
