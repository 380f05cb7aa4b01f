#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include "mjcf/mjcf_world.hpp"

namespace dlo::compare {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Largest number of vertices of a composite; equals the largest nesting depth of bodies.
constexpr std::size_t most_vertices = 1000;

/// Reads vertices that are given by their coordinates.
std::vector<Vector3d> given_vertices(const MjcfNode& node) {
  const std::vector<double> v = *node.numbers("vertex", 6, 3 * most_vertices);
  if (v.size() % 3 != 0) node.fail("vertex", "(allowed: three numbers each)");
  for (const char* other : {"count", "curve", "quat"}) {
    if (node.element.attribute(other))
      node.fail(other, "given besides vertex (allowed: one of them)");
  }
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < v.size(); i += 3) points.emplace_back(v[i], v[i + 1], v[i + 2]);
  return points;
}

/// Returns the function of s for each coordinate: s, cos(s), sin(s) or 0.
std::vector<std::string> curve_of(const MjcfNode& node) {
  std::istringstream words(node.element.attribute("curve").as_string("s 0 0"));
  std::vector<std::string> curve;
  for (std::string word; words >> word;) {
    if (word != "s" && word != "cos(s)" && word != "sin(s)" && word != "0") {
      node.fail("curve", "(allowed: up to three of s, cos(s), sin(s), 0)");
    }
    curve.push_back(word);
  }
  if (curve.empty() || curve.size() > 3) {
    node.fail("curve", "(allowed: one to three of s, cos(s), sin(s), 0)");
  }
  curve.resize(3, "0");
  return curve;
}

/// Returns vertices on a curve: s increases to size[0], the arguments of sin and cos to pi size[2],
/// and the radius is size[1].
std::vector<Vector3d> curve_vertices(const MjcfNode& node) {
  const auto counts = node.numbers("count", 1, 3);
  const double count = counts ? counts->front() : 0;
  if (!(count >= 3 && count <= most_vertices) || count != std::floor(count)) {
    node.fail("count", fmt::format("(allowed: N 1 1 with N from 3 to {} vertices)", most_vertices));
  }
  for (std::size_t i = 1; i < counts->size(); ++i) {
    if ((*counts)[i] != 1) node.fail("count", "of more than one dimension (allowed: N 1 1)");
  }
  std::vector<double> size = node.numbers("size", 1, 3).value_or(std::vector{0.0});
  size.resize(3, 0);
  const Quaterniond turn(node.pose().linear());
  const std::vector<std::string> curve = curve_of(node);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    const double angle = std::numbers::pi * share * size[2];
    Vector3d point = Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double value = curve[k] == "s"        ? share * size[0]
                           : curve[k] == "cos(s)" ? size[1] * std::cos(angle)
                           : curve[k] == "sin(s)" ? size[1] * std::sin(angle)
                                                  : 0;
      point[static_cast<Eigen::Index>(k)] = value;
    }
    points.push_back(turn * point);
  }
  return points;
}

/// Elements of a composite that apply to all its bodies.
struct SharedElements {
  pugi::xml_node geom, joint, plugin;
};

SharedElements shared_elements(const MjcfNode& node) {
  SharedElements parts;
  for (const pugi::xml_node& child : node.element.children()) {
    const std::string_view name = child.name();
    if (child.type() != pugi::node_element || name == "skin" || name == "site") continue;
    const MjcfNode known{node.file, child};
    known.require_known();
    pugi::xml_node* const part = name == "geom"     ? &parts.geom
                                 : name == "joint"  ? &parts.joint
                                 : name == "plugin" ? &parts.plugin
                                                    : nullptr;
    if (part == nullptr || *part) {
      known.fail("in a composite (allowed: one geom, joint, plugin, skin, site)");
    }
    *part = child;
  }
  if (!parts.geom) node.fail("has no <geom> (allowed: a capsule or a cylinder)");
  return parts;
}

}  // namespace

void add_mjcf_composite(const MjcfNode& node, const MjcfPose& at, std::size_t parent,
                        MjcfWorld& world) {
  node.require_known();
  if (world.composite) node.fail("is a second one (allowed: one cable)");
  world.composite = node.element;
  if (node.element.attribute("type").value() != std::string_view("cable")) {
    node.fail("type", "is no cable (allowed: cable)");
  }
  constexpr std::size_t none = 1;
  constexpr std::size_t free = 2;
  const std::size_t initial = node.choice("initial", {"ball", "none", "free"});
  const std::vector<Vector3d> points =
      node.element.attribute("vertex") ? given_vertices(node) : curve_vertices(node);
  const Vector3d offset = node.vector("offset").value_or(Vector3d::Zero());
  const SharedElements parts = shared_elements(node);
  const std::string prefix = node.element.attribute("prefix").value();
  const std::size_t bodies = points.size() - 1;
  Quaterniond frame = Quaterniond::Identity();
  for (std::size_t i = 0; i < bodies; ++i) {
    const Vector3d edge = points[i + 1] - points[i];
    constexpr double shortest_edge = 1e-9;
    if (!(edge.norm() > shortest_edge)) {
      node.fail(fmt::format("has vertices {} and {} at one place (allowed: apart)", i + 1, i + 2));
    }
    // The frame with x along the segment is rotated by the smallest rotation.
    frame = Quaterniond::FromTwoVectors(frame * Vector3d::UnitX(), edge) * frame;
    MjcfBody body;
    body.name = prefix + (i == 0 ? "B_first" : i + 1 == bodies ? "B_last" : fmt::format("B_{}", i));
    body.parent = i == 0 ? parent : world.bodies.size() - 1;
    body.pose = at * MjcfPose(Eigen::Translation3d(offset + points[i]) * frame);
    body.node = node.element;
    body.geoms.push_back(read_composite_geom({node.file, parts.geom}, edge.norm()));
    if (i > 0 || initial != none) {
      MjcfJoint joint;
      if (parts.joint) {
        joint = read_mjcf_joint({node.file, parts.joint}, MjcfPose::Identity());
      }
      joint.type = i == 0 && initial == free ? MjcfJoint::Type::free : MjcfJoint::Type::ball;
      joint.node = parts.joint ? parts.joint : node.element;
      body.joints.push_back(joint);
    }
    if (parts.plugin) body.plugin = read_mjcf_plugin({node.file, parts.plugin});
    body.moves = world.bodies[body.parent].moves || !body.joints.empty();
    set_mjcf_mass(node.file, {}, body);
    world.bodies.push_back(std::move(body));
  }
  MjcfPose end = MjcfPose::Identity();
  end.translation().x() = (points[bodies] - points[bodies - 1]).norm();
  world.sites.push_back({prefix + "S_first", world.bodies.size() - bodies, MjcfPose::Identity()});
  world.sites.push_back({prefix + "S_last", world.bodies.size() - 1, end});
}

}  // namespace dlo::compare
