#pragma once

#include <string>
#include <vector>

#include "mjcf/mjcf_chain.hpp"
#include "mjcf/mjcf_holds.hpp"

namespace dlo::compare {

/// The geoms of what does not move that collide with a cable, as tables [[obstacle]] of a scene.
/// @param notes  on such as are neglected, added to
/// @throws InputError naming file, line and element of one that no obstacle is like
[[nodiscard]] std::string mjcf_obstacles(const MjcfAttributes& attributes, const MjcfWorld& world,
                                         const MjcfChain& chain, const std::vector<MjcfHold>& holds,
                                         std::vector<std::string>& notes);

}  // namespace dlo::compare
