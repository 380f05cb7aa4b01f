#pragma once

#include <vector>

#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

/// Natural curvature and twist of a table [rod], or its helix.
/// @throws InputError naming file, line, key, value and what is allowed
void read_natural_strains(StrictTable& rod, Scene& scene);

/// Its points without stress, if it has some.
/// @param sections  the tables of the rod's sections, which have been read
/// @throws InputError likewise
void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene);

}  // namespace dlo::compare
