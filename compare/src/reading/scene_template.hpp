#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::compare {

/// How a field is treated that is missing in the scene file.
enum class MissingElements {
  refused,  ///< no element is added to an array
  made,     ///< the next element of an array is added
};

/// A scene file whose fields can be given other values. The values are set in the parsed TOML,
/// which the ordinary reader then reads. A field may have any value that is valid in a scene file,
/// except true, false, tables and texts that are numbers.
///
/// A material that is given by name can be varied in parts, as rod.material.youngs_modulus. The
/// derived field `gamma` scales gravity so that w l^3 / (EI) has its value, whatever else is
/// varied. If fields change EI, a given torsional stiffness that is not varied itself changes in
/// proportion: GJ / EI = 1 / (1 + nu) of a round rod, whatever its modulus and diameter. It stays
/// as given if the file is valid only with other values. GJ of sections never changes.
///
/// Safe to use from several threads at once.
class SceneTemplate {
 public:
  /// @param name  name of the file, for messages and Scene::file
  /// @param folder  folder of the files that fields name, if it is not that of `name`
  /// @throws InputError if the text is neither TOML nor a model that a scene can be made from
  SceneTemplate(const std::string& text, const std::string& name,
                std::vector<Material> known_materials = materials(),
                MissingElements missing = MissingElements::refused, const std::string& folder = "");

  /// Returns the scene with other values. @throws InputError as parse_scene, and for a path that
  /// does not exist
  [[nodiscard]] Scene with(const std::vector<SceneField>& values) const;

 private:
  struct Parsed;  // declared here, so that this header does not include TOML
  std::shared_ptr<const Parsed> parsed_;
};

/// Loads a scene file as a template. Its name is stored without the folder, so that messages, and
/// results derived from them, do not depend on the folder. @throws InputError
[[nodiscard]] SceneTemplate load_scene_template(
    const std::string& path, const std::vector<Material>& known_materials = materials());

}  // namespace dlo::compare
