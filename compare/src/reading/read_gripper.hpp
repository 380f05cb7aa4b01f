#pragma once

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads a table [[gripper]] of a scene whose rod and obstacles have been read.
/// @throws InputError naming file, line, key, value and what is allowed, as the others; also if it
///         is behind or within an obstacle
[[nodiscard]] Gripper read_gripper(StrictTable& table, const Scene& scene);

/// That two clamps which hold the rod's frame know how it twists.
/// @param rod  its table
void check_twist(const Scene& scene, const StrictTable& rod);

/// That a clamp says which way a rod is intrinsically curved, and where its principal axes are.
/// @param sections  the tables of its sections
void check_material_directors(const Scene& scene, const StrictTable& rod,
                              const std::vector<StrictTable>& sections);

/// That the grips alone say where each roll counts from.
/// @param entries  the grippers' tables, in the scene's order
void check_rolls(const Scene& scene, const std::vector<StrictTable>& entries);

}  // namespace dlo::compare
