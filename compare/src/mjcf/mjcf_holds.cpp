#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/quote.hpp"
#include "mjcf/mjcf_chain.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Body of a constraint and the point of attachment.
struct AttachmentPoint {
  std::size_t body = 0;
  MjcfPose frame = MjcfPose::Identity();  ///< frame that the constraint holds, in the body's frame
};

/// Finds the grippers of a chain.
class GripperFinder {
 public:
  GripperFinder(const MjcfAttributes& attributes, const MjcfWorld& world, const MjcfChain& chain)
      : attributes_(attributes), xml_(attributes.xml()), world_(world), chain_(chain) {}

  [[nodiscard]] std::vector<MjcfGripper> find(bool constrained, std::vector<std::string>& notes) {
    add_first_body(notes);
    bool is_soft = false;
    for (const auto& constraint : xml_.root().select_nodes("equality/*")) {
      if (!constrained) break;
      attributes_.refusals().attempt([&] {
        is_soft = add({attributes_, constraint.node()}) || is_soft;
      });
    }
    if (is_soft) notes.emplace_back("soft constraints are treated as rigid grippers");
    attributes_.refusals().throw_if_any();
    if (holds_.empty()) {
      xml_.fail(world_.bodies[chain_.segments.front().body].node,
                "begins a cable that nothing holds (allowed: a first body without a free joint, or "
                "weld and connect in <equality>)");
    }
    // Clamps in their reference poses do not twist the cable.
    for (MjcfGripper& hold : holds_) {
      if (!is_clamp_rotated_) hold.d1.reset();
    }
    return std::move(holds_);
  }

 private:
  [[nodiscard]] const MjcfBody& body_of(std::size_t segment) const {
    return world_.bodies[chain_.segments[segment].body];
  }

  /// Returns the tangent of a rod that is clamped at a segment in its reference pose.
  [[nodiscard]] Vector3d tangent(std::size_t segment) const {
    return body_of(segment).pose.linear() * chain_.segments[segment].direction();
  }

  void add_first_body(std::vector<std::string>& notes) {
    const MjcfSegment& first = chain_.segments.front();
    const MjcfBody& body = body_of(0);
    MjcfGripper hold;
    hold.position = body.pose * first.begin;
    if (body.joints.empty()) {
      hold.direction = tangent(0);
      hold.d1 = reference_d1(0);
      hold.words = "the first body is fixed";
    } else if (body.joints.front().type == MjcfJoint::Type::free) {
      return;
    } else {
      double stiffness = 0;
      for (const MjcfJoint& joint : body.joints) stiffness = std::max(stiffness, joint.stiffness);
      hold.words = "the first body's joint is at a fixed place";
      if (stiffness > 0) {
        hold.direction = tangent(0);
        hold.words = "the first body has a joint with a spring";
        notes.push_back(fmt::format(
            "the spring of the first joint, {:.4g} times the others', is treated as a clamp",
            stiffness / chain_.spring));
      }
    }
    holds_.push_back(std::move(hold));
  }

  /// Adds the gripper of a constraint. @return whether it holds the chain
  bool add(const MjcfNode& constraint) {
    const std::string_view kind = constraint.element.name();
    if (kind != "weld" && kind != "connect") {
      constraint.fail("in <equality> has no counterpart in a rod's scene (allowed: weld, connect)");
    }
    constraint.require_known();
    if (constraint.choice("active", {"true", "false"}) == 1) return false;
    const bool by_sites = !constraint.element.attribute("site1").empty();
    AttachmentPoint first = by_sites ? site(constraint, "site1") : body(constraint, "body1");
    AttachmentPoint second = by_sites ? site(constraint, "site2") : body(constraint, "body2");
    if (kind == "weld") {
      weld(constraint, first, second, by_sites);
    } else {
      connect(constraint, first, second, by_sites);
    }
    return true;
  }

  [[nodiscard]] AttachmentPoint body(const MjcfNode& constraint, const char* attribute) const {
    const std::string_view name = constraint.element.attribute(attribute).value();
    if (name == "world" || (name.empty() && attribute == std::string_view("body2"))) return {};
    for (std::size_t i = 1; i < world_.bodies.size() && !name.empty(); ++i) {
      if (world_.bodies[i].name == name) return {i, MjcfPose::Identity()};
    }
    constraint.fail(attribute, name.empty() ? "missing (allowed: a body's name)" : "no such body");
  }

  [[nodiscard]] AttachmentPoint site(const MjcfNode& constraint, const char* attribute) const {
    const std::string_view name = constraint.element.attribute(attribute).value();
    for (const MjcfSite& site : world_.sites) {
      if (!name.empty() && site.name == name) return {site.body, site.pose};
    }
    constraint.fail(attribute, name.empty() ? "missing (allowed: a site's name)" : "no such site");
  }

  /// Returns the segment that a constraint holds, which is that of `first` afterwards: `first` and
  /// `second` are exchanged if necessary. The other body must not belong to the cable.
  [[nodiscard]] std::size_t held_segment(const MjcfNode& constraint, AttachmentPoint& first,
                                         AttachmentPoint& second) const {
    const auto a = chain_.segment_of(first.body);
    const auto b = chain_.segment_of(second.body);
    if (a.has_value() == b.has_value()) {
      constraint.fail(a ? "joins the cable with itself (allowed: with a fixed body)"
                        : "does not hold the cable (allowed: a body of it, and one that "
                          "does not move)");
    }
    if (!a) std::swap(first, second);
    return a ? *a : *b;
  }

  void weld(const MjcfNode& constraint, AttachmentPoint first, AttachmentPoint second,
            bool by_sites) {
    const bool swapped = !chain_.segment_of(first.body);
    const std::size_t k = held_segment(constraint, first, second);
    const MjcfSegment& segment = chain_.segments[k];
    MjcfPose pose = body_of(k).pose;
    const auto relative = constraint.numbers("relpose", 7, 7);
    const bool moved = by_sites || (relative && std::any_of(relative->begin() + 3, relative->end(),
                                                            [](double q) { return q != 0; }));
    if (by_sites) {
      pose = world_.bodies[second.body].pose * second.frame * first.frame.inverse();
    } else if (moved) {
      // Pose of the second body in the frame of the first one.
      const std::vector<double>& v = *relative;
      const MjcfPose relative_pose(Eigen::Translation3d(v[0], v[1], v[2]) *
                                   Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized());
      const MjcfPose other = world_.bodies[second.body].pose;
      pose = swapped ? other * relative_pose : other * relative_pose.inverse();
    }
    const bool last = k + 1 == chain_.segments.size();
    const double share = k == 0 ? 0 : last ? 1 : 0.5;
    MjcfGripper hold;
    hold.at = last ? chain_.length : segment.at + share * segment.length();
    hold.position = pose * (segment.begin + share * (segment.end - segment.begin));
    hold.direction = pose.linear() * segment.direction();
    // The rod's d1 in the reference pose rotates with the body.
    hold.d1 = pose.linear() * body_of(k).pose.linear().transpose() * reference_d1(k);
    is_clamp_rotated_ = is_clamp_rotated_ || moved;
    hold.words = fmt::format("<weld> holds {}", quoted_piece(body_of(k).name));
    add_gripper(constraint, std::move(hold));
  }

  void connect(const MjcfNode& constraint, AttachmentPoint first, AttachmentPoint second,
               bool by_sites) {
    const bool swapped = !chain_.segment_of(first.body);
    const Vector3d anchor =
        by_sites ? Vector3d::Zero() : constraint.vector("anchor").value_or(Vector3d::Zero());
    if (!by_sites && !constraint.element.attribute("anchor")) {
      constraint.fail("anchor", "missing (allowed: a place in body1)");
    }
    const std::size_t k = held_segment(constraint, first, second);
    const MjcfSegment& segment = chain_.segments[k];
    MjcfGripper hold;
    Vector3d own = anchor;
    if (by_sites) {
      own = first.frame.translation();
      hold.position = world_.bodies[second.body].pose * second.frame.translation();
    } else if (swapped) {
      hold.position = world_.bodies[second.body].pose * anchor;
      own = body_of(k).pose.inverse() * hold.position;
    } else {
      hold.position = body_of(k).pose * anchor;
    }
    const double along = (own - segment.begin).dot(segment.direction());
    const double across = (own - segment.begin - along * segment.direction()).norm();
    constexpr double axis_tolerance = 1e-3;
    const double slack = axis_tolerance * segment.length();
    if (across > slack || along < -slack || along > segment.length() + slack) {
      constraint.fail(
          fmt::format("holds {} at a point off its segment: {:.4g} m along it, {:.4g} m away "
                      "(allowed: 0 to {:.4g} m along it, 0 away)",
                      quoted_piece(body_of(k).name), along, across, segment.length()));
    }
    hold.at = std::clamp(segment.at + along, 0.0, chain_.length);
    if (hold.at > chain_.length - slack) hold.at = chain_.length;
    if (hold.at < slack) hold.at = 0;
    hold.words = fmt::format("<connect> holds {}", quoted_piece(body_of(k).name));
    add_gripper(constraint, std::move(hold));
  }

  /// Returns a unit vector perpendicular to the rod, transported without twist along its reference
  /// pose.
  [[nodiscard]] Vector3d reference_d1(std::size_t segment) const {
    const Vector3d first = tangent(0);
    Vector3d d1 = first.unitOrthogonal();
    for (std::size_t i = 1; i <= segment; ++i) {
      d1 = Eigen::Quaterniond::FromTwoVectors(tangent(i - 1), tangent(i)) * d1;
    }
    return d1;
  }

  void add_gripper(const MjcfNode& constraint, MjcfGripper hold) {
    for (const MjcfGripper& other : holds_) {
      if (std::abs(other.at - hold.at) < 1e-9 * chain_.length) {
        constraint.fail(
            fmt::format("constrains the cable where it is already constrained: {} (allowed: "
                        "one of the two)",
                        other.words));
      }
    }
    holds_.push_back(std::move(hold));
  }

  const MjcfAttributes& attributes_;
  const XmlFile& xml_;
  const MjcfWorld& world_;
  const MjcfChain& chain_;
  std::vector<MjcfGripper> holds_;
  bool is_clamp_rotated_ = false;  // whether a weld gives a rotation (sites or relpose)
};

}  // namespace

std::vector<MjcfGripper> find_mjcf_grippers(const MjcfAttributes& attributes,
                                            const MjcfWorld& world, const MjcfChain& chain,
                                            bool constrained, std::vector<std::string>& notes) {
  return GripperFinder(attributes, world, chain).find(constrained, notes);
}

}  // namespace dlo::compare
