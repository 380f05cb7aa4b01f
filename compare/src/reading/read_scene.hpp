#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A parsed scene: TOML, or a simulator's model converted to TOML.
struct SceneSource {
  toml::table root;
  std::string where;                ///< name of the TOML in messages: `file`, or "FILE, as a scene"
  std::string file;                 ///< file that it was read from
  std::optional<ModelChain> model;  ///< model that it was made from
};

/// Parses a scene's text.
/// @param file  name of the file, for messages @throws InputError as parse_scene
[[nodiscard]] SceneSource parse_scene_source(const std::string& text, const std::string& file);

/// Reads a scene from parsed TOML. @throws InputError as parse_scene
[[nodiscard]] Scene read_scene(const toml::table& root, const std::string& file,
                               const std::vector<Material>& known_materials);

/// Reads a scene from a parsed source, and adds the model that it was made from.
[[nodiscard]] Scene read_scene(const SceneSource& source,
                               const std::vector<Material>& known_materials);

/// Returns 16 hexadecimal digits that identify a text up to accidental collisions (XXH3, 64 bits).
[[nodiscard]] std::string fingerprint(const std::string& text);

}  // namespace dlo::compare
