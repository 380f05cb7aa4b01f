#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Reads the table [rod] and the tables [[section]] into a scene whose gravity is known.
/// @throws InputError naming file, line, key, value and what is allowed
void read_rod(StrictTable& rod, std::vector<StrictTable>& sections,
              const std::vector<Material>& known_materials, Scene& scene);

}  // namespace dlo::compare
