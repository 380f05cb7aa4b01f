#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mjcf/mjcf_chain.hpp"

namespace dlo::compare {

/// A gripper of a cable.
struct MjcfHold {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< of a clamp, unit
  std::optional<Eigen::Vector3d> d1;  ///< of a clamp that turns it from its reference
  std::string words;                  ///< "the first body is fixed"
};

/// What holds a cable: a first body that is fixed or jointed to what is, and constraints weld and
/// connect to what does not move.
/// @param constrained  whether constraints count;  @param notes  on what was assumed, added to
/// @throws InputError naming file, line, element and attribute of what no gripper does
[[nodiscard]] std::vector<MjcfHold> find_mjcf_holds(const MjcfAttributes& attributes,
                                                    const MjcfWorld& world, const MjcfChain& chain,
                                                    bool constrained,
                                                    std::vector<std::string>& notes);

}  // namespace dlo::compare
