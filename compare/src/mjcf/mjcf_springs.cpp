#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mjcf/mjcf_body.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Largest cosine of the angle between axes that count as perpendicular, and largest difference of
/// the cosine from 1 for axes that count as parallel [-].
constexpr double axis_alignment_tolerance = 1e-6;

MjcfSpring spring_of_ball(const XmlFile& xml, const MjcfBody& body, double h) {
  if (body.joints.size() > 1) {
    xml.fail(body.joints[1].node, "is a second joint besides a ball (allowed: one ball joint)");
  }
  const double spring = body.joints.front().stiffness * h;
  MjcfSpring result{spring, spring, Vector3d::Zero()};
  if (!body.plugin) return result;
  if (body.geoms.empty() || !body.geoms.front().is_round()) {
    xml.fail(body.node,
             "has a cable plugin and a section that is not round (allowed: a capsule or cylinder "
             "as its first geom)");
  }
  // Second moment of area of a circle; the polar moment is twice as large.
  const double I = std::numbers::pi / 4 * std::pow(body.geoms.front().size[0], 4);
  result.bending += body.plugin->bend * I;
  result.twisting += body.plugin->twist * 2 * I;
  return result;
}

MjcfSpring spring_of_hinges(const XmlFile& xml, const MjcfBody& body, const Vector3d& direction,
                            double h) {
  if (body.plugin) {
    xml.fail(body.node, "has a cable plugin and hinges (allowed: a ball joint)");
  }
  MjcfSpring result;
  std::vector<Vector3d> axes;
  for (const MjcfJoint& joint : body.joints) {
    if (joint.type != MjcfJoint::Type::hinge) {
      xml.fail(joint.node, "besides a hinge (allowed: hinges alone, or one ball joint)");
    }
    const double EI = joint.stiffness * h;
    const double along = std::abs(joint.axis.dot(direction));
    if (along > 1 - axis_alignment_tolerance) {
      result.twisting += EI;
      continue;
    }
    if (along > axis_alignment_tolerance) {
      xml.fail(joint.node, "axis", "is oblique (allowed: across the segment, or along it)");
    }
    const auto is_across = [&](const Vector3d& other) {
      return std::abs(other.dot(joint.axis)) <= axis_alignment_tolerance;
    };
    if (!std::all_of(axes.begin(), axes.end(), is_across)) {
      xml.fail(joint.node, "axis", "is not at a right angle to the hinge's before");
    }
    if (!axes.empty() && !nearly_equal(EI, result.bending)) {
      xml.fail(
          joint.node, "stiffness",
          fmt::format("differs from {:.6g}, the stiffness of the other hinge (allowed: the same)",
                      result.bending / h));
    }
    axes.push_back(joint.axis);
    result.bending = EI;
  }
  if (axes.empty()) {
    xml.fail(body.node, "has no hinge across its segment (allowed: one or two)");
  }
  if (axes.size() == 1) result.hinge = body.pose.linear() * axes.front();
  return result;
}

}  // namespace

bool nearly_equal(double a, double b) {
  constexpr double tolerance = 1e-3;
  return std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b));
}

MjcfSpring mjcf_spring(const XmlFile& xml, const MjcfBody& body, const Vector3d& direction,
                       double h) {
  for (const MjcfJoint& joint : body.joints) {
    if (joint.type != MjcfJoint::Type::free) continue;
    xml.fail(joint.node, "is free: its body is not joined to the one before");
  }
  return body.joints.front().type == MjcfJoint::Type::ball
             ? spring_of_ball(xml, body, h)
             : spring_of_hinges(xml, body, direction, h);
}

}  // namespace dlo::compare
