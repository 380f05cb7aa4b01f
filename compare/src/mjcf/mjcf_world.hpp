#pragma once

#include <string>
#include <vector>

#include "mjcf/mjcf_attributes.hpp"
#include "mjcf/mjcf_body.hpp"

namespace dlo::compare {

/// A site of a body.
struct MjcfSite {
  std::string name;
  std::size_t body = 0;
  MjcfPose pose = MjcfPose::Identity();  ///< pose in the body's frame
};

/// All bodies of a model in MuJoCo's order, the world first; composites are expanded to bodies.
struct MjcfWorld {
  std::vector<MjcfBody> bodies;
  std::vector<MjcfSite> sites;
  pugi::xml_node composite;        ///< composite of the cable; empty if its bodies are written out
  std::vector<std::string> notes;  ///< notes on ignored parts of the model
};

/// Reads the bodies of a model. Elements and attributes that a rod's scene cannot represent are
/// added to the refusals of `attributes`.
/// @throws InputError that names the file if it has no <worldbody>
[[nodiscard]] MjcfWorld read_mjcf_world(const MjcfAttributes& attributes);

/// Adds the bodies, joints and sites of a <composite type="cable"> to a world.
/// @param at  pose of the surrounding frames, in the world;  @param parent  body that contains it
void add_mjcf_composite(const MjcfNode& node, const MjcfPose& at, std::size_t parent,
                        MjcfWorld& world);

}  // namespace dlo::compare
