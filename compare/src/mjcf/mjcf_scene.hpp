#pragma once

#include <string>
#include <string_view>

#include "dlo/compare/model_chain.hpp"

namespace dlo::compare {

/// An MJCF model of a cable, as a scene.
struct MjcfScene {
  std::string text;  ///< of a scene file in TOML
  ModelChain chain;  ///< that it was made from
};

/// Makes a scene of MuJoCo's MJCF: of one composite cable, or one chain of bodies with ball or
/// hinge joints and springs. Its rod is as long as the segments together, its mass theirs (that of
/// a capsule with both caps), EI and GJ a joint's spring times half of both its segments, or those
/// that the plugin mujoco.elasticity.cable makes of its moduli. Fixed bodies and the constraints
/// weld and connect are grippers, geoms that it collides with obstacles.
/// @param file  its name, for messages
/// @throws InputError naming file, line, element and attribute of what a rod's scene cannot say
[[nodiscard]] MjcfScene mjcf_scene(std::string_view text, const std::string& file);

}  // namespace dlo::compare
