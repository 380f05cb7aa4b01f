#pragma once

#include <array>
#include <cstddef>

#include "../helpers.hpp"
#include "dlo/energy_model/chain.hpp"

namespace dlo::test {

inline constexpr std::array joint_laws = {
    energy_model::JointLaw::paper, energy_model::JointLaw::hooke, energy_model::JointLaw::linear,
    energy_model::JointLaw::binormal};

/// Returns the name of a joint law, for the names of tests.
inline const char* name_of(energy_model::JointLaw law) {
  constexpr const char* names[] = {"paper", "hooke", "linear", "binormal"};
  return names[static_cast<std::size_t>(law)];
}

}  // namespace dlo::test
