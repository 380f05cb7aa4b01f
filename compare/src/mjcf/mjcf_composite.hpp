#pragma once

#include "mjcf/mjcf_world.hpp"

namespace dlo::compare {

/// Adds the bodies, joints and sites of a <composite type="cable"> to a world.
/// @param at  of the frames around it, in the world;  @param parent  body that it is in
void add_mjcf_composite(const MjcfAttributes& attributes, const pugi::xml_node& node,
                        const MjcfPose& at, std::size_t parent, MjcfWorld& world);

}  // namespace dlo::compare
