#include "mjcf/mjcf_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "base/quote.hpp"
#include "mjcf/mjcf_attributes.hpp"

namespace dlo::compare {
namespace {

/// Reads nested bodies.
class WorldReader {
 public:
  explicit WorldReader(const MjcfAttributes& attributes)
      : attributes_(attributes), xml_(attributes.xml()) {
    world_.bodies.emplace_back();
    world_.bodies.front().name = "world";
    world_.bodies.front().node = xml_.root();
  }

  [[nodiscard]] MjcfWorld read() {
    const auto worlds = xml_.root().children("worldbody");
    if (worlds.empty()) xml_.fail(xml_.root(), "has no <worldbody> (allowed: one, with a cable)");
    for (const pugi::xml_node& node : worlds) {
      read_children(node, {0, MjcfPose::Identity(), ""});
    }
    fix_base();
    note_ignored();
    return std::move(world_);
  }

 private:
  /// Surroundings of an element.
  struct Surroundings {
    std::size_t body;
    MjcfPose at;  ///< pose of the surrounding frames, in the body
    std::string childclass;
  };

  void read_children(const pugi::xml_node& parent, const Surroundings& around) {
    // Nested bodies are read after all other elements of a body.
    for (const auto read : {&WorldReader::read_part, &WorldReader::read_inner}) {
      for (const pugi::xml_node& element : parent.children()) {
        if (element.type() != pugi::node_element) continue;
        const MjcfNode node{attributes_, element, around.childclass};
        attributes_.refusals().attempt([&] { (this->*read)(node, around); });
      }
    }
  }

  void read_inner(const MjcfNode& node, const Surroundings& around) {
    const std::string_view name = node.element.name();
    if (name == "body") read_body(node, around);
    if (name == "frame") read_children(node.element, within(node, around));
    if (name == "composite") {
      add_mjcf_composite(node, world_.bodies[around.body].pose * around.at, around.body, world_);
    }
  }

  [[nodiscard]] Surroundings within(const MjcfNode& frame, const Surroundings& around) const {
    frame.require_known();
    return {around.body, around.at * frame.pose(),
            attributes_.known_class(frame.element, "childclass", around.childclass)};
  }

  void read_part(const MjcfNode& node, const Surroundings& around) {
    const std::string_view name = node.element.name();
    MjcfBody& body = world_.bodies[around.body];
    if (name == "body" || name == "frame" || name == "composite" || mjcf_without_effect(name)) {
      return;
    }
    if (name == "geom") {
      body.geoms.push_back(read_mjcf_geom(node, around.at));
    } else if (name == "site") {
      node.require_known();
      world_.sites.push_back(
          {node.element.attribute("name").value(), around.body, around.at * node.pose()});
    } else if (around.body > 0 && (name == "joint" || name == "freejoint")) {
      body.joints.push_back(read_mjcf_joint(node, around.at));
    } else if (around.body > 0 && name == "plugin") {
      body.plugin = read_mjcf_plugin(node);
    } else if (around.body == 0 || name != "inertial") {
      node.fail(
          "has no counterpart in a rod's scene here, or is unknown (allowed: body, geom, "
          "site, frame, composite, and of a body joint, inertial, plugin)");
    }
  }

  void read_body(const MjcfNode& node, const Surroundings& around) {
    node.require_known();
    MjcfBody body;
    body.name = node.element.attribute("name").value();
    body.parent = around.body;
    body.node = node.element;
    body.pose = world_.bodies[around.body].pose * around.at * node.pose();
    MjcfNode{attributes_, node.element}.require_zero("gravcomp", "removes part of the weight");
    const std::size_t index = world_.bodies.size();
    world_.bodies.push_back(std::move(body));
    const std::string childclass =
        attributes_.known_class(node.element, "childclass", around.childclass);
    // The body's other elements are read first, then its mass is known, then nested bodies are
    // read.
    const Surroundings inside{index, MjcfPose::Identity(), childclass};
    read_children(node.element, inside);
    set_mjcf_mass(attributes_, node.element.child("inertial"), world_.bodies[index]);
  }

  /// Removes joints that only move the cable as a whole, and finds the bodies that move.
  void fix_base() {
    using Type = MjcfJoint::Type;
    const bool held = !xml_.root().select_node("equality/*[not(@active='false')]").node().empty();
    const auto carries = [&](const MjcfJoint& joint) {
      return joint.type == Type::slide || (joint.type == Type::free && !held);
    };
    std::size_t last = 0;  // last body that can bend the cable
    for (std::size_t i = 1; i < world_.bodies.size(); ++i) {
      if (std::ranges::any_of(world_.bodies[i].joints, &MjcfJoint::rotates)) last = i;
    }
    for (std::size_t i = 1; i < world_.bodies.size(); ++i) {
      MjcfBody& body = world_.bodies[i];
      const bool at_base = i <= last && !world_.bodies[body.parent].moves;
      if (at_base && std::erase_if(body.joints, carries) > 0) {
        world_.notes.push_back(fmt::format(
            "slide or free joint of {} is ignored: the base is fixed where the model puts it",
            body.name.empty() ? fmt::format("body {}", i) : quoted_piece(body.name)));
      }
      for (const MjcfJoint& joint : body.joints) {
        if (joint.type != Type::slide) continue;
        attributes_.refusals().attempt([&] {
          xml_.fail(joint.node, "type",
                    "slide of a segment (allowed: ball, hinge; slide and free at the base alone)");
        });
      }
      body.moves = world_.bodies[body.parent].moves || !body.joints.empty();
    }
  }

  void note_ignored() {
    const pugi::xml_node root = xml_.root();
    std::set<std::string_view> held;
    for (const auto& used : root.select_nodes("equality/*/@site1 | equality/*/@site2")) {
      held.insert(used.attribute().value());
    }
    const auto sites = root.select_nodes("worldbody//site");
    const auto loose = std::count_if(sites.begin(), sites.end(), [&](const auto& site) {
      return !held.contains(site.node().attribute("name").value());
    });
    std::vector<std::string> parts;
    const auto add = [&](std::size_t count, const char* name) {
      if (count > 0) parts.push_back(fmt::format("{} {}{}", count, name, count == 1 ? "" : "s"));
    };
    add(root.select_nodes("actuator/*").size(), "actuator");
    add(root.select_nodes("sensor/*").size(), "sensor");
    add(static_cast<std::size_t>(loose), "site");
    if (!parts.empty()) world_.notes.push_back(fmt::format("ignored: {}", fmt::join(parts, ", ")));
  }

  const MjcfAttributes& attributes_;
  const XmlFile& xml_;
  MjcfWorld world_;
};

}  // namespace

MjcfWorld read_mjcf_world(const MjcfAttributes& attributes) {
  return WorldReader(attributes).read();
}

}  // namespace dlo::compare
