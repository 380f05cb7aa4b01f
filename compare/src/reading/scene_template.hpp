#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::compare {

/// What a field may be of that the scene file lacks.
enum class MissingElements {
  refused,  ///< no element of an array
  made,     ///< the next element of an array
};

/// A scene file whose fields can be given other values. They go into its parsed TOML, and that goes
/// through the ordinary reader: what a scene file may say is what a field may say.
///
/// A material that is given by name can be varied in parts, as rod.material.youngs_modulus. The
/// derived field `gamma` scales gravity so that w l^3 / (EI) is its value, whatever else is varied.
/// Where fields change EI, a torsional stiffness that is not varied itself changes with it: GJ / EI
/// = 1 / (1 + nu) of a round rod, whatever its modulus and diameter.
///
/// Safe to use from several threads at once.
class SceneTemplate {
 public:
  /// @param name  of the file, for messages and Scene::file
  /// @param folder  that rod.rest_shape is relative to, where it is not that of the name
  /// @throws InputError if the text is no TOML
  SceneTemplate(const std::string& text, std::string name,
                std::vector<Material> known_materials = materials(),
                MissingElements missing = MissingElements::refused, const std::string& folder = "");

  /// The scene with other values. @throws InputError as parse_scene, and if a path leads nowhere
  [[nodiscard]] Scene with(const std::vector<SceneField>& values) const;

 private:
  struct Parsed;  // keeps TOML out of this header
  std::shared_ptr<const Parsed> parsed_;
};

/// A scene file as a template. Its name goes without its folder, so that messages, and what is
/// derived from them, are the same wherever the file lies. @throws InputError
[[nodiscard]] SceneTemplate load_scene_template(
    const std::string& path, const std::vector<Material>& known_materials = materials());

}  // namespace dlo::compare
