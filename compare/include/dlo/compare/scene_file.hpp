#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Reads a scene. @param file  its name, for messages and Scene::file
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& file,
                                const std::vector<Material>& known_materials = materials());

/// Reads a scene file. @throws InputError as parse_scene, or if it cannot be read
[[nodiscard]] Scene load_scene(const std::string& path,
                               const std::vector<Material>& known_materials = materials());

/// The three scenes of the paper's Figs. 12 and 13, built into the library (data/scenes).
[[nodiscard]] std::vector<Scene> paper_scenes();

}  // namespace dlo::compare
