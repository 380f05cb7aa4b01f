#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjcf/mjcf_world.hpp"

namespace dlo::compare {

/// A rigid body of a cable, from its joint to the next one.
struct MjcfSegment {
  std::size_t body = 0;
  /// Begin of the segment, in the body's frame [m].
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();  ///< end of the segment, in the body's frame [m]
  double at = 0;                                  ///< arc length of its start [m]

  [[nodiscard]] double length() const { return (end - begin).norm(); }
  [[nodiscard]] Eigen::Vector3d direction() const { return (end - begin).normalized(); }
};

/// An interval of a cable with constant stiffness and mass per length.
struct MjcfSection {
  double from = 0, to = 0;         ///< arc lengths [m]
  double bending_stiffness = 0;    ///< EI [N m^2]
  double torsional_stiffness = 0;  ///< GJ [N m^2]; 0: none
  double mass_per_length = 0;      ///< [kg/m]
};

/// A model's cable as a rod.
struct MjcfChain {
  std::vector<MjcfSegment> segments;
  double length = 0;             ///< [m]
  double mass = 0;               ///< [kg]
  double bending_stiffness = 0;  ///< EI [N m^2], the mean of the joints
  /// GJ [N m^2], the mean of the joints; 0 if a joint transmits no torque or does not allow twist.
  double torsional_stiffness = 0;
  /// Empty if all segments have the same mass and all joints the same springs; else covers the
  /// whole rod.
  std::vector<MjcfSection> sections;
  /// Largest diameter of the geoms before the first one that is neither round nor a sphere [m]; 0:
  /// there is none.
  double diameter = 0;
  double spring = 0;  ///< mean stiffness of the joints between two segments [N m/rad]
  /// Axis of the hinges if they allow bending in one plane only, in the world; zero: bending about
  /// every axis is possible.
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
  bool is_curved = false;          ///< whether the stress-free shape is curved
  std::string words;               ///< "a composite cable", "a chain of bodies with ball joints"
  std::vector<std::string> notes;  ///< assumptions

  /// Returns the index in `segments`; empty for a body that is not one of them.
  [[nodiscard]] std::optional<std::size_t> segment_of(std::size_t body) const;
};

/// Finds the only chain of bodies and the properties of an equivalent rod.
/// @throws InputError that names file, line, element and attribute of what no rod has
[[nodiscard]] MjcfChain find_mjcf_chain(const MjcfAttributes& attributes, const MjcfWorld& world);

/// A gripper of a cable.
struct MjcfGripper {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< unit vector of a clamp
  /// d1 of a clamp; empty for all clamps if no weld gives a rotation (sites or relpose), and for a
  /// clamp that stands for the spring of the first joint.
  std::optional<Eigen::Vector3d> d1;
  std::string words;  ///< "the first body is fixed"
};

/// Finds the grippers of a cable: a first body that is fixed or jointed to a fixed body, and
/// constraints weld and connect to fixed bodies.
/// @param constrained  whether constraints count;  @param notes  receives the assumptions
/// @throws InputError that names file, line, element and attribute of what no gripper can
/// represent, or the first body if nothing holds the cable
[[nodiscard]] std::vector<MjcfGripper> find_mjcf_grippers(const MjcfAttributes& attributes,
                                                          const MjcfWorld& world,
                                                          const MjcfChain& chain, bool constrained,
                                                          std::vector<std::string>& notes);

/// Returns the geoms of fixed bodies that collide with the cable's last body, as tables
/// [[obstacle]] of a scene. Geoms around a gripper are neglected. A geom that no obstacle can
/// represent is added to the refusals of `attributes`.
/// @param notes  receives the number of neglected ones
/// @throws InputError that names an element of <contact> other than exclude
[[nodiscard]] std::string mjcf_obstacles(const MjcfAttributes& attributes, const MjcfWorld& world,
                                         const MjcfChain& chain,
                                         const std::vector<MjcfGripper>& holds,
                                         std::vector<std::string>& notes);

}  // namespace dlo::compare
