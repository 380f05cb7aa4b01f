#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "base/quote.hpp"
#include "mjcf/mjcf_chain.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;
using Type = MjcfGeom::Type;

/// Returns the names of bodies whose contact with the cable is disabled by <contact><exclude>.
std::set<std::string> excluded_bodies(const XmlFile& xml, const MjcfWorld& world,
                                      const MjcfChain& chain) {
  std::set<std::string> names;
  const auto is_cable = [&](const std::string& name) {
    return std::ranges::any_of(chain.segments, [&](const MjcfSegment& segment) {
      return world.bodies[segment.body].name == name;
    });
  };
  for (const auto& found : xml.root().select_nodes("contact/*")) {
    const pugi::xml_node part = found.node();
    if (std::string_view(part.name()) != "exclude") {
      xml.fail(part, "in <contact> has no counterpart in a rod's scene (allowed: exclude)");
    }
    const std::string first = part.attribute("body1").value();
    const std::string second = part.attribute("body2").value();
    if (is_cable(first) != is_cable(second)) names.insert(is_cable(first) ? second : first);
  }
  return names;
}

/// Returns the radius of a sphere that contains the geom [m]; 0 for a plane.
double bounding_radius(const MjcfGeom& geom) {
  return geom.type == Type::capsule ? geom.size.sum() : geom.size.norm();
}

/// Returns the shape of a geom for a table [[obstacle]]; empty if no obstacle has such a shape.
std::string shape_text(const MjcfGeom& geom, const MjcfPose& pose) {
  const std::string point = toml_vector(pose.translation());
  const Vector3d axis = pose.linear().col(2);
  switch (geom.type) {
    case Type::plane:
      return fmt::format("shape = \"plane\"\npoint = {}\nnormal = {}\n", point, toml_vector(axis));
    case Type::sphere:
      return fmt::format("shape = \"sphere\"\npoint = {}\nradius = {:.17g}\n", point, geom.size[0]);
    case Type::capsule:
      return fmt::format(
          "shape = \"capsule\"\npoint = {}\naxis = {}\nradius = {:.17g}\nlength = {:.17g}\n", point,
          toml_vector(axis), geom.size[0], 2 * geom.size[1]);
    case Type::box:
      return fmt::format("shape = \"box\"\npoint = {}\naxis = {}\nnormal = {}\nsize = {}\n", point,
                         toml_vector(pose.linear().col(0)), toml_vector(pose.linear().col(1)),
                         toml_vector(2 * geom.size));
    case Type::ellipsoid:
    case Type::cylinder:
    case Type::other:
      break;
  }
  return "";
}

}  // namespace

std::string mjcf_obstacles(const MjcfAttributes& attributes, const MjcfWorld& world,
                           const MjcfChain& chain, const std::vector<MjcfGripper>& holds,
                           std::vector<std::string>& notes) {
  const XmlFile& xml = attributes.xml();
  const std::set<std::string> excluded_names = excluded_bodies(xml, world, chain);
  const MjcfBody& last = world.bodies[chain.segments.back().body];
  std::string text;
  int neglected = 0;
  for (const MjcfBody& body : world.bodies) {
    if (body.moves || excluded_names.contains(body.name)) continue;
    if (chain.segment_of(static_cast<std::size_t>(&body - world.bodies.data()))) continue;
    for (const MjcfGeom& geom : body.geoms) {
      const bool collides =
          std::ranges::any_of(last.geoms, [&](const MjcfGeom& own) { return geom.collides(own); });
      if (!collides) continue;
      const MjcfPose pose = body.pose * geom.pose;
      const bool holds_it = std::ranges::any_of(holds, [&](const MjcfGripper& hold) {
        return geom.type != Type::plane &&
               (hold.position - pose.translation()).norm() < bounding_radius(geom) + chain.diameter;
      });
      if (holds_it) {
        ++neglected;
        continue;
      }
      const std::string shape = shape_text(geom, pose);
      if (shape.empty()) {
        attributes.refusals().attempt([&] {
          xml.fail(geom.node, "type",
                   "of a geom that the cable may touch (allowed: plane, sphere, capsule, box; or "
                   "contype and conaffinity 0)");
        });
      }
      text += "\n[[obstacle]]\n" + shape;
      double friction = geom.friction;
      for (const MjcfGeom& own : last.geoms) friction = std::max(friction, own.friction);
      if (friction > 0) append(text, "friction = {:.17g}\n", friction);
    }
  }
  if (neglected > 0) {
    notes.push_back(fmt::format("{} geom{} around a held place {} neglected", neglected,
                                neglected == 1 ? "" : "s", neglected == 1 ? "is" : "are"));
  }
  return text;
}

}  // namespace dlo::compare
