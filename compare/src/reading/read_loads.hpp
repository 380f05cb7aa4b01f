#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads a table [[load]] of a scene whose rod has been read.
/// @throws InputError naming file, line, key, value and what is allowed, as the others
[[nodiscard]] PointLoad read_load(StrictTable& table, const Scene& scene);

/// The same of [[distributed_load]].
[[nodiscard]] DistributedLoad read_distributed_load(StrictTable& table, const Scene& scene);

/// Reads [medium] into a scene whose obstacles have been read.
void read_medium(StrictTable& table, Scene& scene);

/// What has no potential, and couples, act on a rod that touches nothing; what follows it, where no
/// clamp holds it.
/// @param entries  the loads' tables, in the scene's order
void check_turning_loads(const Scene& scene, const std::vector<StrictTable>& entries);

}  // namespace dlo::compare
