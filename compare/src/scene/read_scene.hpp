#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Reads a scene from TOML that is parsed already. @throws InputError as parse_scene
[[nodiscard]] Scene read_scene(const toml::table& root, const std::string& file,
                               const std::vector<Material>& known_materials);

}  // namespace dlo::compare
