#pragma once

#include <Eigen/Core>
#include <string>

#include "mjcf/mjcf_attributes.hpp"

namespace dlo::compare {

/// A geom of a body.
struct MjcfGeom {
  enum class Type { plane, sphere, capsule, ellipsoid, cylinder, box, other };
  Type type = Type::sphere;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< as MJCF has it [m]
  MjcfPose pose = MjcfPose::Identity();            ///< in the body
  double mass = 0;                                 ///< [kg]
  int contype = 1, conaffinity = 1;                ///< bits of what it collides with
  double friction = 1;                             ///< sliding [-]
  pugi::xml_node node;                             ///< for messages

  /// Whether it is round about its axis z, from an end to another.
  [[nodiscard]] bool is_round() const { return type == Type::capsule || type == Type::cylinder; }
  /// Ends of its axis in the body, those of a capsule without caps [m]; of a box those of its
  /// longest edge, of others its middle.
  [[nodiscard]] Eigen::Vector3d end(double sign) const;
  /// Whether two collide.
  [[nodiscard]] bool collides(const MjcfGeom& other) const {
    return (contype & other.conaffinity) != 0 || (other.contype & conaffinity) != 0;
  }
};

/// [m^3]; a capsule's is that of a cylinder and a sphere, its caps.
[[nodiscard]] double mjcf_volume(const MjcfGeom& geom);

/// Reads a geom. @param at  of the frames around it, in the body
[[nodiscard]] MjcfGeom read_mjcf_geom(const MjcfAttributes& attributes, const pugi::xml_node& node,
                                      const MjcfPose& at, const std::string& childclass);

/// The same of a composite's geom, whose ends are the segment's: along x from 0 to `length`.
/// Default classes say nothing of it.
[[nodiscard]] MjcfGeom read_composite_geom(const MjcfAttributes& attributes,
                                           const pugi::xml_node& node, double length);

}  // namespace dlo::compare
