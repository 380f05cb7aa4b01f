#include "mjcf/mjcf_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "decode/xml.hpp"
#include "mjcf/mjcf_attributes.hpp"
#include "mjcf/mjcf_chain.hpp"
#include "mjcf/mjcf_world.hpp"

namespace dlo::compare {
namespace {

using Eigen::Vector3d;

/// Values of <option>.
struct Options {
  Vector3d gravity = {0, 0, -9.81};
  bool equality = true, contact = true;
};

Options read_options(const MjcfAttributes& attributes) {
  Options options;
  for (const pugi::xml_node& element : attributes.xml().root().children("option")) {
    const MjcfNode node{attributes, element};
    options.gravity = node.vector("gravity").value_or(options.gravity);
    const bool fluid =
        node.number("density").value_or(0) != 0 || node.number("viscosity").value_or(0) != 0;
    if (fluid) node.require_zero("wind", "of a fluid drags the cable");
    for (const pugi::xml_node& child : element.children()) {
      if (child.type() != pugi::node_element) continue;
      const MjcfNode flag{attributes, child};
      flag.require_known();
      const auto is_off = [&](const char* name) {
        return flag.choice(name, {"enable", "disable"}) == 1;
      };
      for (const char* name : {"passive", "spring"}) {
        if (is_off(name)) flag.fail(name, "disables the springs (allowed: enable)");
      }
      if (is_off("gravity")) options.gravity.setZero();
      if (is_off("equality") || is_off("constraint")) options.equality = false;
      if (is_off("contact") || is_off("constraint")) options.contact = false;
    }
  }
  return options;
}

/// Returns the stress-free shape as rows of points.
std::string rest_points(const MjcfWorld& world, const MjcfChain& chain) {
  std::string rows;
  for (const MjcfSegment& segment : chain.segments) {
    rows += toml_vector(world.bodies[segment.body].pose * segment.begin) + ",\n  ";
  }
  const MjcfSegment& last = chain.segments.back();
  return "[" + rows + toml_vector(world.bodies[last.body].pose * last.end) + "]";
}

/// Checks that gravity is in the plane of hinges with one axis. The hinges would carry the
/// component perpendicular to it, a rod does not.
void require_in_plane(const XmlFile& xml, const MjcfWorld& world, const MjcfChain& chain,
                      const Vector3d& gravity) {
  constexpr double axis_alignment_tolerance = 1e-6;
  if (!(std::abs(chain.hinge.dot(gravity)) > axis_alignment_tolerance * gravity.norm())) return;
  xml.fail(world.bodies[chain.segments[1].body].joints.front().node, "axis",
           "lets the cable bend only in a plane that does not contain gravity, so the hinges carry "
           "weight (allowed: gravity at a right angle to the hinges; or two hinges, or a ball)");
}

std::string grippers_text(const std::vector<MjcfGripper>& holds) {
  std::string text;
  for (const MjcfGripper& hold : holds) {
    append(text, "\n[[gripper]]  # {}\nat = {:.17g}\nposition = {}\nhold = \"{}\"\n",
           printable_piece(hold.words), hold.at, toml_vector(hold.position),
           hold.direction ? "clamp" : "pin");
    if (!hold.direction) continue;
    if (!hold.d1) {
      append(text, "direction = {}\n", toml_vector(*hold.direction));
      continue;
    }
    append(text, "frame = [{}, {}, {}]\n", toml_vector(*hold.d1),
           toml_vector(hold.direction->cross(*hold.d1)), toml_vector(*hold.direction));
  }
  return text;
}

std::string rod_text(const MjcfWorld& world, const MjcfChain& chain) {
  std::string text = fmt::format(
      "\n[rod]\nlength = {:.17g}\nbending_stiffness = {:.17g}\nmass_per_length = {:.17g}\n",
      chain.length, chain.bending_stiffness, chain.mass / chain.length);
  if (chain.torsional_stiffness > 0) {
    append(text, "torsional_stiffness = {:.17g}\n", chain.torsional_stiffness);
  }
  if (chain.diameter > 0) append(text, "diameter = {:.17g}\n", chain.diameter);
  if (chain.is_curved) append(text, "rest_shape = {}\n", rest_points(world, chain));
  return text;
}

std::string sections_text(const MjcfChain& chain) {
  std::string text;
  for (const MjcfSection& section : chain.sections) {
    append(text,
           "\n[[section]]\nfrom = {:.17g}\nto = {:.17g}\nbending_stiffness = {:.17g}\n"
           "mass_per_length = {:.17g}\n",
           section.from, section.to, section.bending_stiffness, section.mass_per_length);
    if (section.torsional_stiffness > 0) {
      append(text, "torsional_stiffness = {:.17g}\n", section.torsional_stiffness);
    }
  }
  return text;
}

}  // namespace

MjcfScene mjcf_scene(std::string_view text, const std::string& file) {
  const XmlFile xml(text, file);
  XmlRefusals refusals;
  const MjcfAttributes attributes(xml, refusals);
  Options options;
  refusals.attempt([&] { options = read_options(attributes); });
  const MjcfWorld world = read_mjcf_world(attributes);
  refusals.throw_if_any();
  MjcfChain chain = find_mjcf_chain(attributes, world);
  require_in_plane(xml, world, chain, options.gravity);
  std::vector<std::string> notes = std::move(chain.notes);
  notes.insert(notes.end(), world.notes.begin(), world.notes.end());
  const std::vector<MjcfGripper> holds =
      find_mjcf_grippers(attributes, world, chain, options.equality, notes);
  const std::string name =
      xml.root().attribute("model").as_string(std::filesystem::path(file).stem().c_str());
  std::string scene = fmt::format("name = {}\ngravity = {}\n", toml_string(valid_utf8(name)),
                                  toml_vector(options.gravity));
  scene += rod_text(world, chain) + sections_text(chain) + grippers_text(holds);
  if (options.contact) scene += mjcf_obstacles(attributes, world, chain, holds, notes);
  refusals.throw_if_any();
  return {std::move(scene),
          {.words = "MJCF, " + chain.words,
           .notes = std::move(notes),
           .segments = static_cast<Eigen::Index>(chain.segments.size()),
           .first_body = static_cast<Eigen::Index>(chain.segments.front().body),
           .bodies = static_cast<Eigen::Index>(world.bodies.size())}};
}

}  // namespace dlo::compare
