#include "mjcf/mjcf_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/quote.hpp"
#include "mjcf/mjcf_body.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Largest distance of a point from the axis, divided by the length of a segment, at which it
/// counts as on the axis [-].
constexpr double axis_tolerance = 1e-3;
/// Largest angle between segments that count as collinear [rad].
constexpr double collinear_angle = 1e-6;

/// Finds the chain, segment by segment.
class ChainFinder {
 public:
  ChainFinder(const MjcfAttributes& attributes, const MjcfWorld& world)
      : xml_(attributes.xml()), refusals_(attributes.refusals()), world_(world) {}

  [[nodiscard]] MjcfChain find() {
    const std::vector<std::size_t> bodies = bodies_along();
    for (std::size_t i = 0; i < bodies.size(); ++i) add_segment(bodies, i);
    set_lengths();
    set_mass();
    set_diameter();
    set_rest_shape();
    set_joints();
    refusals_.throw_if_any();
    set_sections();
    chain_.words = world_.composite
                       ? "a composite cable"
                       : fmt::format("a chain of bodies with {} joints",
                                     chain_.torsional_stiffness > 0 ? "ball" : "hinge");
    return std::move(chain_);
  }

 private:
  [[nodiscard]] const MjcfBody& body_of(const MjcfSegment& segment) const {
    return world_.bodies[segment.body];
  }

  [[nodiscard]] std::string name_of(std::size_t body) const {
    const std::string& name = world_.bodies[body].name;
    return name.empty() ? fmt::format("body {}", body) : quoted_piece(name);
  }

  [[noreturn]] void fail(const MjcfSegment& segment, const std::string& problem) const {
    xml_.fail(body_of(segment).node, fmt::format("{} {}", name_of(segment.body), problem));
  }

  void refuse(const MjcfSegment& segment, const std::string& problem) const {
    refusals_.attempt([&] { fail(segment, problem); });
  }

  /// Returns the start of a body's segment, in the body [m].
  [[nodiscard]] Vector3d begin_of(std::size_t body) const {
    const std::vector<MjcfJoint>& joints = world_.bodies[body].joints;
    for (const MjcfJoint& joint : joints) {
      if ((joint.place - joints.front().place).norm() <= 1e-9) continue;
      xml_.fail(joint.node, "pos", "is not the position of the body's first joint");
    }
    const bool jointed = !joints.empty() && joints.front().type != MjcfJoint::Type::free;
    return jointed ? joints.front().place : Vector3d::Zero();
  }

  /// Returns the moving bodies from one end to the other, without those that only name a position,
  /// preceded by the body that holds the first one if that body is a segment itself.
  [[nodiscard]] std::vector<std::size_t> bodies_along() {
    std::vector<std::size_t> along;
    for (std::size_t i = 1; i < world_.bodies.size(); ++i) {
      const MjcfBody& body = world_.bodies[i];
      if (!body.moves) continue;
      if (is_marker_body(i)) {
        chain_.notes.push_back(
            fmt::format("{} is ignored: it has no mass and no joint", name_of(i)));
        continue;
      }
      if (!along.empty() && body.parent != along.back()) {
        xml_.fail(body.node, fmt::format("{} is not in {}: a branch, or a second chain (allowed: "
                                         "one chain, each body in the one before)",
                                         name_of(i), name_of(along.back())));
      }
      if (body.joints.empty() && !along.empty()) {
        xml_.fail(body.node, fmt::format("{} has no joint: fixed to the segment before, which no "
                                         "rod has (allowed: a ball or hinge joint)",
                                         name_of(i)));
      }
      along.push_back(i);
    }
    if (along.empty()) {
      xml_.fail(xml_.root(), "has no body with a joint (allowed: one cable)");
    }
    const std::size_t holder = world_.bodies[along.front()].parent;
    if (holder > 0 && is_segment(holder, along)) {
      along.insert(along.begin(), holder);
    } else if (holder > 0) {
      chain_.notes.push_back(fmt::format(
          "{} is treated as the base that the cable is fixed to, not as a segment of it",
          name_of(holder)));
    }
    if (along.size() < 2) {
      xml_.fail(world_.bodies[along.front()].node,
                "is the only body of its chain (allowed: two segments or more)");
    }
    return along;
  }

  /// Whether a body only names a position: it has no joint, geom, mass or nested body.
  [[nodiscard]] bool is_marker_body(std::size_t i) const {
    const MjcfBody& body = world_.bodies[i];
    const auto is_inside = [i](const MjcfBody& other) { return other.parent == i; };
    return body.joints.empty() && body.geoms.empty() && !(body.mass > 0) &&
           std::none_of(world_.bodies.begin() + 1, world_.bodies.end(), is_inside);
  }

  /// Whether a fixed body is the first segment: it holds a composite, or it is as long as the next
  /// one and has a geom that ends at the joint of the next one.
  [[nodiscard]] bool is_segment(std::size_t holder, const std::vector<std::size_t>& along) const {
    const MjcfBody& body = world_.bodies[holder];
    if (world_.composite && body.node == world_.composite) return true;
    const Vector3d joint = segment_start_in(along.front(), holder);
    const Vector3d next = along.size() > 1 ? segment_start_in(along[1], along[0]) : joint;
    const double h = along.size() > 1 ? (next - begin_of(along[0])).norm() : joint.norm();
    return nearly_equal(joint.norm(), h) &&
           std::ranges::any_of(body.geoms, [&](const MjcfGeom& geom) {
             return std::min((geom.end(1) - joint).norm(), (geom.end(-1) - joint).norm()) <=
                    0.1 * h;
           });
  }

  /// Returns the start of a body's segment, in another body [m].
  [[nodiscard]] Vector3d segment_start_in(std::size_t body, std::size_t other) const {
    return world_.bodies[other].pose.inverse() * (world_.bodies[body].pose * begin_of(body));
  }

  void add_segment(const std::vector<std::size_t>& bodies, std::size_t i) {
    MjcfSegment segment;
    segment.body = bodies[i];
    segment.begin = begin_of(bodies[i]);
    segment.at = chain_.length;
    segment.end = i + 1 < bodies.size() ? segment_start_in(bodies[i + 1], bodies[i])
                                        : end_of_last_segment(segment);
    constexpr double shortest_segment = 1e-9;
    if (!(segment.length() > shortest_segment)) {
      fail(segment, "has no length: the next joint is at the same position (allowed: apart)");
    }
    chain_.length += segment.length();
    chain_.segments.push_back(segment);
  }

  /// Returns the end of the last segment: the end of a geom that is farthest from the last joint.
  [[nodiscard]] Vector3d end_of_last_segment(const MjcfSegment& segment) const {
    Vector3d farthest = segment.begin;
    for (const MjcfGeom& geom : body_of(segment).geoms) {
      for (const double sign : {-1.0, 1.0}) {
        const Vector3d end = geom.end(sign);
        if ((end - segment.begin).norm() > (farthest - segment.begin).norm()) farthest = end;
      }
    }
    if (farthest == segment.begin) {
      fail(segment,
           "is the last one, and no geom defines its end (allowed: a capsule, cylinder or box from "
           "its joint to its end)");
    }
    return farthest;
  }

  void set_lengths() {
    const double h = chain_.segments.front().length();
    for (const MjcfSegment& segment : chain_.segments) {
      if (nearly_equal(segment.length(), h)) continue;
      refuse(segment, fmt::format("is {:.6g} m long, and the first segment {:.6g} m (allowed: "
                                  "segments of one length)",
                                  segment.length(), h));
    }
  }

  void set_mass() {
    double largest_offset = 0;  // of a centre of mass from the middle of its segment, in segments
    for (const MjcfSegment& segment : chain_.segments) {
      const MjcfBody& body = body_of(segment);
      chain_.mass += body.mass;
      const Vector3d from_begin = body.centre - segment.begin;
      const double along = from_begin.dot(segment.direction());
      const double across = (from_begin - along * segment.direction()).norm();
      if (body.mass > 0 && across > axis_tolerance * segment.length()) {
        refuse(segment, fmt::format("has its mass {:.4g} m off its axis (allowed: on it)", across));
      }
      const double offset = std::abs(along / segment.length() - 0.5);
      if (body.mass > 0 && offset > largest_offset) largest_offset = offset;
    }
    if (largest_offset > 1e-2) {
      chain_.notes.push_back(
          fmt::format("mass of segments made uniform: centres move up to {:.2g} segment lengths",
                      largest_offset));
    }
  }

  void set_diameter() {
    for (const MjcfSegment& segment : chain_.segments) {
      for (const MjcfGeom& geom : body_of(segment).geoms) {
        if (!geom.is_round() && geom.type != MjcfGeom::Type::sphere) return;
        chain_.diameter = std::max(chain_.diameter, 2 * geom.size[0]);
      }
    }
  }

  void set_rest_shape() {
    Vector3d before = Vector3d::Zero();
    for (const MjcfSegment& segment : chain_.segments) {
      const Vector3d t = body_of(segment).pose.linear() * segment.direction();
      if (before.norm() > 0 && before.cross(t).norm() > collinear_angle) chain_.is_curved = true;
      if (before.norm() > 0 && before.dot(t) < 0) {
        refuse(segment,
               "is rotated by more than a right angle from the one before (allowed: less)");
      }
      before = t;
    }
    const std::optional<MjcfPlugin>& plugin = body_of(chain_.segments.back()).plugin;
    if (chain_.is_curved && plugin && plugin->flat) {
      chain_.is_curved = false;
      chain_.notes.emplace_back("the stress-free cable is straight (flat)");
    }
  }

  /// Computes EI from the springs: each is multiplied by the length that it represents, half of
  /// both adjacent segments.
  void set_joints() {
    for (std::size_t i = 1; i < chain_.segments.size(); ++i) {
      const MjcfSegment& segment = chain_.segments[i];
      const double h = (segment.length() + chain_.segments[i - 1].length()) / 2;
      refusals_.attempt([&] {
        springs_.push_back(mjcf_spring(xml_, body_of(segment), segment.direction(), h));
        require_axis(segment, springs_.back());
        if (springs_.back().bending > 0) return;
        fail(segment,
             "has no spring in its joint (allowed: stiffness > 0, or the plugin "
             "mujoco.elasticity.cable with bend > 0)");
      });
    }
    if (springs_.empty()) return;
    const bool twists = std::ranges::all_of(springs_, [](const auto& s) { return s.twisting > 0; });
    for (const MjcfSpring& spring : springs_) {
      const auto count = static_cast<double>(springs_.size());
      chain_.bending_stiffness += spring.bending / count;
      if (twists) chain_.torsional_stiffness += spring.twisting / count;
    }
    chain_.hinge = springs_.front().hinge;
    chain_.spring = chain_.bending_stiffness / chain_.segments.front().length();
    for (const MjcfSegment& segment : chain_.segments) {
      if (!std::ranges::any_of(body_of(segment).joints, &MjcfJoint::is_limited)) continue;
      chain_.notes.emplace_back("limits of joints are assumed not to be reached");
      return;
    }
  }

  void require_axis(const MjcfSegment& segment, const MjcfSpring& spring) const {
    const Vector3d& first = springs_.front().hinge;
    if (first.cross(spring.hinge).norm() <= collinear_angle &&
        (first.norm() > 0) == (spring.hinge.norm() > 0)) {
      return;
    }
    xml_.fail(body_of(segment).joints.front().node, "axis",
              "differs from the axis of the first joint (allowed: one axis for all bodies)");
  }

  /// Sets stiffnesses and masses of halves of segments, of which equal ones are joined.
  void set_sections() {
    const std::size_t halves = 2 * chain_.segments.size();
    const double half = chain_.length / static_cast<double>(halves);
    const double h = chain_.length / static_cast<double>(chain_.segments.size());
    std::vector<MjcfSection>& sections = chain_.sections;
    for (std::size_t i = 0; i < halves; ++i) {
      const double from = static_cast<double>(i) * half;
      const double to = i + 1 == halves ? chain_.length : from + half;
      const double middle = (from + to) / 2;
      const auto segment = static_cast<std::size_t>(middle / h);
      // The spring of joint i, between segments i and i + 1, represents the part of the rod that is
      // nearest to it.
      const double joint =
          std::clamp(std::round(middle / h) - 1, 0.0, static_cast<double>(springs_.size()) - 1);
      const MjcfSpring& spring = springs_[static_cast<std::size_t>(joint)];
      const MjcfSection next{from, to, spring.bending,
                             chain_.torsional_stiffness > 0 ? spring.twisting : 0,
                             body_of(chain_.segments[segment]).mass / h};
      const bool has_next_section =
          !sections.empty() &&
          nearly_equal(sections.back().bending_stiffness, next.bending_stiffness) &&
          nearly_equal(sections.back().torsional_stiffness, next.torsional_stiffness) &&
          nearly_equal(sections.back().mass_per_length, next.mass_per_length);
      if (has_next_section) {
        sections.back().to = next.to;
      } else {
        sections.push_back(next);
      }
    }
    if (sections.size() == 1) return sections.clear();
    const auto [softest, stiffest] = std::ranges::minmax(springs_, {}, &MjcfSpring::bending);
    chain_.notes.push_back(fmt::format("the cable has {} sections, EI {:.4g} to {:.4g} N m^2",
                                       sections.size(), softest.bending, stiffest.bending));
  }

  const XmlFile& xml_;
  XmlRefusals& refusals_;
  const MjcfWorld& world_;
  MjcfChain chain_;
  std::vector<MjcfSpring> springs_;  // between segments, in the order of the chain
};

}  // namespace

std::optional<std::size_t> MjcfChain::segment_of(std::size_t body) const {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (segments[i].body == body) return i;
  }
  return std::nullopt;
}

MjcfChain find_mjcf_chain(const MjcfAttributes& attributes, const MjcfWorld& world) {
  return ChainFinder(attributes, world).find();
}

}  // namespace dlo::compare
