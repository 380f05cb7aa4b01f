#pragma once

#include <Eigen/Core>
#include <string>

#include "mjcf/mjcf_attributes.hpp"

namespace dlo::compare {

/// A geom of a body.
struct MjcfGeom {
  enum class Type { plane, sphere, capsule, ellipsoid, cylinder, box, other };
  Type type = Type::sphere;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< half-sizes [m]; 0 for a plane
  MjcfPose pose = MjcfPose::Identity();            ///< pose in the body's frame
  double mass = 0;                                 ///< [kg]
  int contype = 1, conaffinity = 1;                ///< bit masks for collisions
  double friction = 1;                             ///< sliding [-]
  pugi::xml_node node;                             ///< XML element, for messages

  /// Whether it is a capsule or a cylinder.
  [[nodiscard]] bool is_round() const { return type == Type::capsule || type == Type::cylinder; }
  /// Returns an end of its axis in the body, for a capsule without the cap [m]. The axis of a box
  /// is parallel to its longest edge; other geoms have no axis, and their middle is returned.
  /// @param sign  1 or -1, the end
  [[nodiscard]] Eigen::Vector3d end(double sign) const;
  /// Whether two geoms collide.
  [[nodiscard]] bool collides(const MjcfGeom& other) const {
    return (contype & other.conaffinity) != 0 || (other.contype & conaffinity) != 0;
  }
};

/// Reads a geom. @param at  pose of the surrounding frames, in the body
[[nodiscard]] MjcfGeom read_mjcf_geom(const MjcfNode& node, const MjcfPose& at);

/// Reads a composite's geom, which extends over the segment, along x from 0 to `length`. Of the
/// default classes only the main one applies, without its pose.
[[nodiscard]] MjcfGeom read_composite_geom(const MjcfNode& node, double length);

}  // namespace dlo::compare
