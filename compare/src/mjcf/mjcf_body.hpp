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
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< in the body [m]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< of a hinge, unit, in the body
  double stiffness = 0;                             ///< [N m/rad]
  bool is_limited = false;                          ///< it has a range
  pugi::xml_node node;                              ///< for messages

  /// Whether it lets two segments rotate against each other.
  [[nodiscard]] bool rotates() const { return type == Type::hinge || type == Type::ball; }
};

/// The plugin mujoco.elasticity.cable of a body.
struct MjcfPlugin {
  double bend = 0;    ///< E [Pa]
  double twist = 0;   ///< G [Pa]
  bool flat = false;  ///< whether the cable is straight where it is free of stress

  /// In every field.
  bool operator==(const MjcfPlugin&) const = default;
};

/// A body, in the model's reference pose.
struct MjcfBody {
  std::string name;
  std::size_t parent = 0;
  MjcfPose pose = MjcfPose::Identity();  ///< in the world
  bool moves = false;                    ///< it, or one that it is in, has a joint
  std::vector<MjcfJoint> joints;
  std::vector<MjcfGeom> geoms;
  std::optional<MjcfPlugin> plugin;
  double mass = 0;                                   ///< of its inertial or its geoms [kg]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of that mass, in the body [m]
  pugi::xml_node node;                               ///< for messages
};

/// Reads a joint. @param at  of the frames around it, in the body
[[nodiscard]] MjcfJoint read_mjcf_joint(const MjcfAttributes& attributes,
                                        const pugi::xml_node& node, const MjcfPose& at,
                                        const std::string& childclass);

/// Reads a body's <plugin>, or a composite's.
[[nodiscard]] MjcfPlugin read_mjcf_plugin(const MjcfAttributes& attributes,
                                          const pugi::xml_node& node);

/// Sets mass and centre from the geoms. @param inertial  the element, if there is one
void set_mjcf_mass(const MjcfAttributes& attributes, const pugi::xml_node& inertial,
                   MjcfBody& body);

/// What the joint between two segments makes of a rod like them.
struct MjcfSpring {
  double bending = 0;   ///< EI [N m^2]
  double twisting = 0;  ///< GJ [N m^2]; 0: it holds no twist, or does not let it be
  /// Axis of a single hinge across the segment, in the world, unit; zero: it bends everywhere.
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
};

/// Lengths, masses and springs of one rod are alike to a thousandth: what files are rounded to.
[[nodiscard]] bool are_alike(double a, double b);

/// Of a body's joints and its cable plugin.
/// @param direction  of its segment, in the body, unit
/// @param h  length that the joint stands for, half of both its segments [m]
/// @throws InputError naming file, line, element and attribute of what no rod is like
[[nodiscard]] MjcfSpring mjcf_spring(const XmlFile& xml, const MjcfBody& body,
                                     const Eigen::Vector3d& direction, double h);

}  // namespace dlo::compare
