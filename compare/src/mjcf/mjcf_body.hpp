#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjcf/mjcf_attributes.hpp"
#include "mjcf/mjcf_geom.hpp"

namespace dlo::compare {

/// A joint of a body.
struct MjcfJoint {
  enum class Type { hinge, ball, free, slide };
  Type type = Type::hinge;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< position in the body [m]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< axis of a hinge in the body, unit vector
  double stiffness = 0;                             ///< [N m/rad]
  bool is_limited = false;                          ///< whether it has a range that is in force
  pugi::xml_node node;                              ///< XML element, for messages

  /// Whether two segments can rotate relative to each other at the joint.
  [[nodiscard]] bool rotates() const { return type == Type::hinge || type == Type::ball; }
};

/// Plugin mujoco.elasticity.cable of a body.
struct MjcfPlugin {
  double bend = 0;    ///< E [Pa]
  double twist = 0;   ///< G [Pa]
  bool flat = false;  ///< whether the stress-free cable is straight

  bool operator==(const MjcfPlugin&) const = default;
};

/// A body in the model's reference pose.
struct MjcfBody {
  std::string name;
  std::size_t parent = 0;
  MjcfPose pose = MjcfPose::Identity();  ///< pose in the world
  bool moves = false;                    ///< whether it, or a body that contains it, has a joint
  std::vector<MjcfJoint> joints;
  std::vector<MjcfGeom> geoms;
  std::optional<MjcfPlugin> plugin;
  double mass = 0;                                   ///< mass of its inertial or its geoms [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centre of mass, in the body [m]
  pugi::xml_node node;                               ///< XML element, for messages
};

/// Reads a joint. @param at  pose of the surrounding frames, in the body
[[nodiscard]] MjcfJoint read_mjcf_joint(const MjcfNode& node, const MjcfPose& at);

/// Reads the <plugin> of a body or of a composite.
[[nodiscard]] MjcfPlugin read_mjcf_plugin(const MjcfNode& node);

/// Sets mass and centre of a body from its <inertial>, or from its geoms if it has none or the
/// compiler's inertiafromgeom is true. @param inertial  the element, if there is one
/// @throws InputError if inertiafromgeom is false without <inertial>, or if its mass is not >= 0
void set_mjcf_mass(const MjcfAttributes& attributes, const pugi::xml_node& inertial,
                   MjcfBody& body);

/// Stiffnesses of a rod that correspond to the joint between two segments.
struct MjcfSpring {
  double bending = 0;   ///< EI [N m^2]
  double twisting = 0;  ///< GJ [N m^2]; 0: the joint transmits no torque, or does not allow twist
  /// Axis of a single hinge perpendicular to the segment, in the world, unit vector; zero: bending
  /// about every axis is possible.
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
};

/// Whether two lengths, masses or stiffnesses of a rod are equal within 0.1 %, the rounding of
/// files.
[[nodiscard]] bool nearly_equal(double a, double b);

/// Computes the stiffnesses that correspond to a body's joints and its cable plugin.
/// @param direction  direction of its segment in the body, unit vector
/// @param h  length that the joint represents, half of both adjacent segments [m]
/// @throws InputError that names file, line, element and attribute of what no rod can represent
[[nodiscard]] MjcfSpring mjcf_spring(const XmlFile& xml, const MjcfBody& body,
                                     const Eigen::Vector3d& direction, double h);

}  // namespace dlo::compare
