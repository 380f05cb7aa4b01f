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
void read_config(const MjcfNode& node, MjcfPlugin& plugin) {
  for (const auto& child : node.element.select_nodes("*")) {
    const MjcfNode config{node.file, child.node()};
    config.require_known();
    const std::string key = config.element.attribute("key").value();
    const std::string_view value = config.element.attribute("value").value();
    if (key == "flat") {
      plugin.flat = value == "true";
      if (!plugin.flat && value != "false") config.fail("value", "(allowed: true, false)");
    } else if (key == "twist" || key == "bend") {
      const std::optional<double> modulus = shape_number(value);
      // The negated condition also rejects NaN.
      if (!modulus || !(*modulus >= 0 && *modulus <= 1e15)) {
        config.fail("value", fmt::format("of {} (allowed: a modulus in Pa, 0 to 1e15)", key));
      }
      (key == "twist" ? plugin.twist : plugin.bend) = *modulus;
    } else if (key != "vmax") {
      config.fail("key", "unknown" + did_you_mean(key, {"twist", "bend", "flat", "vmax"}) +
                             " (allowed: twist, bend, flat, vmax)");
    }
  }
}

/// Returns the <instance> with that name. @throws InputError if there is none
MjcfNode instance_of(const MjcfNode& node) {
  const char* name = node.element.attribute("instance").value();
  for (const auto& plugin : node.file.xml().root().select_nodes("extension/plugin")) {
    const pugi::xml_node found = plugin.node().find_child_by_attribute("instance", "name", name);
    if (found && plugin.node().attribute("plugin").value() == cable_plugin) {
      return {node.file, found};
    }
  }
  node.fail("instance", fmt::format("no such instance of {} in <extension>", cable_plugin));
}

}  // namespace

MjcfPlugin read_mjcf_plugin(const MjcfNode& node) {
  node.require_known();
  MjcfPlugin plugin;
  const bool by_name = !node.element.attribute("instance").empty();
  const std::string_view name = node.element.attribute("plugin").value();
  if (name != cable_plugin && !(by_name && name.empty())) {
    node.fail("plugin", fmt::format("is not read (allowed: {})", cable_plugin));
  }
  if (by_name) {
    const MjcfNode instance = instance_of(node);
    instance.require_known();
    read_config(instance, plugin);
  }
  read_config(node, plugin);
  return plugin;
}

MjcfJoint read_mjcf_joint(const MjcfNode& node, const MjcfPose& at) {
  node.require_known();
  MjcfJoint joint;
  joint.node = node.element;
  if (std::string_view(node.element.name()) == "freejoint") {
    joint.type = MjcfJoint::Type::free;
    return joint;
  }
  constexpr MjcfJoint::Type types[] = {MjcfJoint::Type::hinge, MjcfJoint::Type::ball,
                                       MjcfJoint::Type::free, MjcfJoint::Type::slide};
  joint.type = types[node.choice("type", {"hinge", "ball", "free", "slide"})];
  joint.place = at * node.vector("pos").value_or(Eigen::Vector3d::Zero());
  const Eigen::Vector3d axis = node.vector("axis").value_or(Eigen::Vector3d::UnitZ());
  constexpr double least_axis_norm = 1e-10;
  if (!(axis.norm() > least_axis_norm)) node.fail("axis", "has no direction");
  joint.axis = at.linear() * axis.normalized();
  joint.stiffness = node.number("stiffness").value_or(0);
  if (!(joint.stiffness >= 0)) node.fail("stiffness", "(allowed: 0 or more, in N m/rad)");
  joint.is_limited = node.text("range") && node.text("limited").value_or("auto") != "false";
  node.require_zero("springdamper", "makes a stiffness of inertias");
  node.require_zero("frictionloss", "allows many equilibria");
  if (joint.type == MjcfJoint::Type::hinge) {
    const double rest = node.number("springref").value_or(0);
    const double reference = node.number("ref").value_or(0);
    if (rest != reference) {
      node.fail("springref",
                fmt::format("differs from ref = {:g}: the joint is bent in its stress-free state "
                            "(allowed: springref = ref, or bodies posed stress-free)",
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
    const MjcfNode given{attributes, inertial};
    given.require_known();
    const std::optional<double> mass = given.number("mass");
    if (!mass || !(*mass >= 0)) {
      given.fail("mass", "missing or negative (allowed: 0 or more, in kg)");
    }
    body.mass = *mass;
    body.centre = given.vector("pos").value_or(Eigen::Vector3d::Zero());
    return;
  }
  for (const MjcfGeom& geom : body.geoms) {
    body.mass += geom.mass;
    body.centre += geom.mass * geom.pose.translation();
  }
  if (body.mass > 0) body.centre /= body.mass;
}

}  // namespace dlo::compare
