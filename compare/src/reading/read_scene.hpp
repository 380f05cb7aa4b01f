#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A scene's text, parsed: TOML, or a simulator's model made TOML.
struct SceneSource {
  toml::table root;
  std::string where;                ///< what the lines of the TOML are of, for messages
  std::string file;                 ///< that it was read from
  std::optional<ModelChain> model;  ///< that it was made from
};

/// @param file  its name, for messages @throws InputError as parse_scene
[[nodiscard]] SceneSource parse_scene_source(const std::string& text, const std::string& file);

/// Reads a scene from TOML that is parsed already. @throws InputError as parse_scene
[[nodiscard]] Scene read_scene(const toml::table& root, const std::string& file,
                               const std::vector<Material>& known_materials);

/// The same, with the model that it was made from.
[[nodiscard]] Scene read_scene(const SceneSource& source,
                               const std::vector<Material>& known_materials);

/// 16 hexadecimal digits that differ for different texts, but for accidents (XXH3, 64 bits).
[[nodiscard]] std::string fingerprint(const std::string& text);

}  // namespace dlo::compare
