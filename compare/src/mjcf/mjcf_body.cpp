#include "mjcf/mjcf_body.hpp"

#include <fmt/format.h>

#include <string_view>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"

namespace dlo::compare {
namespace {

constexpr std::string_view cable_plugin = "mujoco.elasticity.cable";

/// Reads the values of a <plugin> or <instance>.
void read_config(const MjcfAttributes& attributes, const pugi::xml_node& node, MjcfPlugin& plugin) {
  const XmlFile& xml = attributes.xml();
  for (const pugi::xml_node& config : node.children()) {
    if (config.type() != pugi::node_element) continue;
    attributes.require_known(config);
    const std::string key = config.attribute("key").value();
    const std::string_view value = config.attribute("value").value();
    if (key == "flat") {
      plugin.flat = value == "true";
      if (!plugin.flat && value != "false") xml.fail(config, "value", "(allowed: true, false)");
    } else if (key == "twist" || key == "bend") {
      const std::optional<double> modulus = shape_number(value);
      // The negated condition also rejects NaN.
      if (!modulus || !(*modulus >= 0 && *modulus <= 1e15)) {
        xml.fail(config, "value", fmt::format("of {} (allowed: a modulus in Pa, 0 to 1e15)", key));
      }
      (key == "twist" ? plugin.twist : plugin.bend) = *modulus;
    } else if (key != "vmax") {
      xml.fail(config, "key",
               "unknown" + did_you_mean(key, {"twist", "bend", "flat", "vmax"}) +
                   " (allowed: twist, bend, flat, vmax)");
    }
  }
}

/// Returns the <instance> with that name. @throws InputError if there is none
pugi::xml_node instance_of(const XmlFile& xml, const pugi::xml_node& node) {
  const char* name = node.attribute("instance").value();
  for (const pugi::xml_node& extension : xml.root().children("extension")) {
    for (const pugi::xml_node& plugin : extension.children("plugin")) {
      const pugi::xml_node found = plugin.find_child_by_attribute("instance", "name", name);
      if (found && plugin.attribute("plugin").value() == cable_plugin) return found;
    }
  }
  xml.fail(node, "instance", fmt::format("no such instance of {} in <extension>", cable_plugin));
}

}  // namespace

MjcfPlugin read_mjcf_plugin(const MjcfAttributes& attributes, const pugi::xml_node& node) {
  const XmlFile& xml = attributes.xml();
  attributes.require_known(node);
  MjcfPlugin plugin;
  const bool by_name = !node.attribute("instance").empty();
  const std::string_view name = node.attribute("plugin").value();
  if (name != cable_plugin && !(by_name && name.empty())) {
    xml.fail(node, "plugin", fmt::format("is not read (allowed: {})", cable_plugin));
  }
  if (by_name) {
    const pugi::xml_node instance = instance_of(xml, node);
    attributes.require_known(instance);
    read_config(attributes, instance, plugin);
  }
  read_config(attributes, node, plugin);
  return plugin;
}

MjcfJoint read_mjcf_joint(const MjcfAttributes& attributes, const pugi::xml_node& node,
                          const MjcfPose& at, const std::string& childclass) {
  const XmlFile& xml = attributes.xml();
  attributes.require_known(node);
  MjcfJoint joint;
  joint.node = node;
  if (std::string_view(node.name()) == "freejoint") {
    joint.type = MjcfJoint::Type::free;
    return joint;
  }
  constexpr MjcfJoint::Type types[] = {MjcfJoint::Type::hinge, MjcfJoint::Type::ball,
                                       MjcfJoint::Type::free, MjcfJoint::Type::slide};
  joint.type =
      types[attributes.choice(node, "type", {"hinge", "ball", "free", "slide"}, childclass)];
  joint.place = at * attributes.vector(node, "pos", childclass).value_or(Eigen::Vector3d::Zero());
  const Eigen::Vector3d axis =
      attributes.vector(node, "axis", childclass).value_or(Eigen::Vector3d::UnitZ());
  constexpr double least = 1e-10;
  if (!(axis.norm() > least)) xml.fail(node, "axis", "has no direction");
  joint.axis = at.linear() * axis.normalized();
  joint.stiffness = attributes.number(node, "stiffness", childclass).value_or(0);
  if (!(joint.stiffness >= 0)) xml.fail(node, "stiffness", "(allowed: 0 or more, in N m/rad)");
  joint.is_limited = attributes.text(node, "range", childclass) &&
                     attributes.text(node, "limited", childclass).value_or("auto") != "false";
  attributes.require_zero(node, "springdamper", "makes a stiffness of inertias", childclass);
  attributes.require_zero(node, "frictionloss", "holds many shapes at rest", childclass);
  if (joint.type == MjcfJoint::Type::hinge) {
    const double rest = attributes.number(node, "springref", childclass).value_or(0);
    const double reference = attributes.number(node, "ref", childclass).value_or(0);
    if (rest != reference) {
      xml.fail(node, "springref",
               fmt::format("is another angle than ref = {:g}: bent where it is free of stress "
                           "(allowed: the same; or the bodies posed as that shape)",
                           reference));
    }
  }
  return joint;
}

void set_mjcf_mass(const MjcfAttributes& attributes, const pugi::xml_node& inertial,
                   MjcfBody& body) {
  const pugi::xml_node compiler = attributes.xml().root().child("compiler");
  const std::string from_geoms = compiler.attribute("inertiafromgeom").as_string("auto");
  if (from_geoms == "false" && !inertial) {
    attributes.xml().fail(body.node, "has no <inertial>, and inertiafromgeom is false");
  }
  if (inertial && from_geoms != "true") {
    attributes.require_known(inertial);
    const std::optional<double> mass = attributes.number(inertial, "mass", "");
    if (!mass || !(*mass >= 0)) {
      attributes.xml().fail(inertial, "mass", "missing or negative (allowed: 0 or more, in kg)");
    }
    body.mass = *mass;
    body.centre = attributes.vector(inertial, "pos", "").value_or(Eigen::Vector3d::Zero());
    return;
  }
  for (const MjcfGeom& geom : body.geoms) {
    body.mass += geom.mass;
    body.centre += geom.mass * geom.pose.translation();
  }
  if (body.mass > 0) body.centre /= body.mass;
}

}  // namespace dlo::compare
