#pragma once

#include <string>
#include <string_view>

#include "dlo/compare/model_chain.hpp"

namespace dlo::compare {

/// An MJCF model of a cable as a scene.
struct MjcfScene {
  std::string text;  ///< scene file in TOML
  ModelChain chain;  ///< chain that it was made from
};

/// Makes a scene from MuJoCo's MJCF with one composite cable, or one chain of bodies with ball or
/// hinge joints and springs. The rod has the total length and mass of the segments (a capsule with
/// both caps). EI and GJ are a joint's spring times half of both adjacent segments, or follow from
/// the moduli of the plugin mujoco.elasticity.cable. Fixed bodies and the constraints weld and
/// connect become grippers, colliding geoms become obstacles.
/// @param file  name of the file, for messages
/// @throws InputError that names file, line, element and attribute that a rod's scene cannot
/// represent
[[nodiscard]] MjcfScene mjcf_scene(std::string_view text, const std::string& file);

}  // namespace dlo::compare
