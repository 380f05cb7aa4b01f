#pragma once

#include "../helpers.hpp"

namespace dlo::test {

/// Text of a scene file: a rope from a pin to the left of a peg, with a load at its end. The rope
/// may hang next to the peg or lie over it.
inline constexpr const char* rope_beside_peg = R"(
gravity = [0, -9.81, 0]
gripper = [{ at = 0, position = [-0.35, 0.06, 0], hold = "pin" }]
load = [{ at = "1 m", mass = "1.5 kg" }]
obstacle = [{ shape = "cylinder", point = [0, 0, 0], axis = [0, 0, 1], radius = "4 cm" }]
[rod]
length = "1 m"
diameter = "6 mm"
bending_stiffness = "5e-3 N m^2"
mass_per_length = "0.06 kg/m"
)";

}  // namespace dlo::test
