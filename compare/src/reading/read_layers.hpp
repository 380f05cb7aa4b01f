#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// The material of a table [rod], by its name or as a table of its own.
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Material read_material(StrictTable& rod,
                                     const std::vector<Material>& known_materials);

/// A cable's section, mass and stiffness. @return whether the rod has layers
/// @throws InputError likewise
[[nodiscard]] bool read_layers(StrictTable& rod, const std::vector<Material>& known_materials,
                               Scene& scene);

}  // namespace dlo::compare
