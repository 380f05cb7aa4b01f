#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/material.hpp"

namespace dlo::compare {

/// Keeps a clamped cross-section from turning about its direction.
struct FrameHold {
  /// First director of the rod's frame, unit and across the direction; none: where the same rod
  /// without twist has it.
  std::optional<Eigen::Vector3d> d1;
  double roll = 0;  ///< turned on from there about the direction, whole turns counted [rad]

  /// In every field.
  bool operator==(const FrameHold&) const = default;
};

/// What holds a point of the rod.
struct Gripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit; a clamp has one, a pin has none
  std::optional<FrameHold> frame;                      ///< of a clamp that does not let it turn
  std::string where;                                   ///< "file:line", for messages

  /// In every field.
  bool operator==(const Gripper&) const = default;
};

/// A force that keeps its direction.
struct PointLoad {
  double at = 0;                                    ///< arc length [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]

  /// In every field.
  bool operator==(const PointLoad&) const = default;
};

/// A half-space that the rod stays out of.
struct Obstacle {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< of the plane [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit, to the free side
  /// Force per depth and per length of rod [N/m^2]; infinite: rigid.
  double stiffness = std::numeric_limits<double>::infinity();

  /// In every field.
  bool operator==(const Obstacle&) const = default;
};

/// A physical scene in SI units.
struct Scene {
  std::string name;                         ///< for people; regression tests know the scene by it
  std::string file;                         ///< where it was read from, for messages
  Eigen::Vector3d gravity = {0, -9.81, 0};  ///< [m/s^2]
  double length = 0;                        ///< l [m]
  double diameter = 0;                      ///< d [m]
  Material material;                        ///< round rod of one material
  /// GJ [N m^2], > 0; needed where two clamps hold frames, of no effect elsewhere.
  std::optional<double> torsional_stiffness;
  std::vector<Gripper> grippers;    ///< one or more, in the file's order
  std::vector<PointLoad> loads;     ///< may be empty
  std::vector<Obstacle> obstacles;  ///< may be empty
  ForceModelSettings force_model;   ///< as the file has it

  [[nodiscard]] double cross_section() const;               ///< A [m^2]
  [[nodiscard]] double bending_stiffness() const;           ///< EI [N m^2]
  [[nodiscard]] double axial_stiffness() const;             ///< EA [N]
  [[nodiscard]] Eigen::Vector3d weight_per_length() const;  ///< rho A g [N/m]
  [[nodiscard]] double mass() const;                        ///< [kg]
  [[nodiscard]] double gamma() const;                       ///< w l^3 / (EI) [-]
  /// Whether two clamps or more hold the rod's frame, which twists it or keeps it from twisting.
  [[nodiscard]] bool holds_twist() const;
  /// The same with clamps that let the rod turn about their directions.
  [[nodiscard]] Scene without_twist() const;
  /// Unit normal of the plane that grips, forces and obstacles in reach share, if they do and no
  /// twist is held, which bends a rod out of its plane; of several planes any one.
  [[nodiscard]] std::optional<Eigen::Vector3d> plane_normal() const;
  /// Whether there is one.
  [[nodiscard]] bool planar() const { return plane_normal().has_value(); }
  [[nodiscard]] int spans() const;  ///< parts that the clamps cut the rod into

  /// Multiplies E, and GJ with it: their ratio is one of Poisson's ratio and the section's shape.
  void scale_modulus(double factor);

  /// In every field.
  bool operator==(const Scene&) const = default;
};

}  // namespace dlo::compare
