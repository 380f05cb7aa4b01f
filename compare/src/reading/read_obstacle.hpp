#pragma once

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads a table [[obstacle]] of a scene whose rod has been read.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Obstacle read_obstacle(StrictTable& table, const Scene& scene);

}  // namespace dlo::compare
