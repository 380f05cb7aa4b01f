#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Correction of a gripper's direction and position, the same in all scenes.
struct ClampCorrection {
  std::size_t gripper = 0;                             ///< index in the scene's order
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rotation vector of its direction [rad]
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< displacement of its position [m]
};

/// Results of a calibration of a rod and of the fixture that holds it: `dlo calibrate -o FILE.toml`
/// writes them, and `--calibrated FILE.toml` applies them to scenes of the same rod in the same
/// fixture.
struct CalibratedRod {
  /// E [Pa], or EI [N m^2] with `by_stiffness`, as in Scene::stiffness.
  std::optional<double> stiffness;
  /// Density [kg/m^3], or mass per length [kg/m] with `by_stiffness`, as in Scene::mass_parameter.
  std::optional<double> mass_parameter;
  bool by_stiffness = false;  ///< whether the rod is given by EI and mass per length
  std::optional<double> torsional_stiffness;  ///< GJ [N m^2]
  /// Natural curvature: coefficients of P_0, P_1, .. about d1 and d2 [1/m]; empty: the scene's.
  std::vector<Eigen::Vector2d> natural_curvature;
  /// Grippers whose direction or position differs from the scenes'.
  std::vector<ClampCorrection> clamps;
  std::optional<double> damping;  ///< Kelvin-Voigt time of the material [s]
  std::optional<double> drag;     ///< drag of the air, force per length and velocity [N s/m^2]
  std::optional<double> quadratic_drag;  ///< across the rod, per squared velocity [N s^2/m^3]
  /// Rotation vector of the camera [rad]: shapes, and gravity with them, are rotated by it about
  /// the first gripper in the coordinates in which they were measured.
  Eigen::Vector3d camera_tilt = Eigen::Vector3d::Zero();
};

/// Returns a scene with the calibrated quantities in place of its own, except damping and drag of
/// motions, which a scene does not have.
/// @throws InputError if the scene is given by E and the calibration by EI or the reverse, if it
/// lacks a corrected gripper, or with `camera_tilt` if more than weight acts on its rod or
/// something moves
[[nodiscard]] Scene calibrated_scene(Scene scene, const CalibratedRod& rod);

/// Reads a calibrated rod from TOML.
/// @throws InputError that names file, line, key and what is allowed
[[nodiscard]] CalibratedRod parse_calibrated_rod(const std::string& text, const std::string& file);
/// Reads a file of a calibrated rod.
/// @throws InputError as parse_calibrated_rod(), or if the file cannot be read
[[nodiscard]] CalibratedRod load_calibrated_rod(const std::string& path);

}  // namespace dlo::compare
