#pragma once

#include <string>
#include <vector>

#include "dlo/compare/material.hpp"

namespace dlo::compare {

/// Content of a new scene file; values as in a scene file, without quotes: "2 m", 0.5, "[0, 0, 1]".
struct SceneChoices {
  std::string name = "rod";           ///< name of the scene
  std::string length = "1 m";         ///< length of the rod
  std::string diameter = "6 mm";      ///< diameter of the rod, round and solid
  std::string material = "silicone";  ///< name of a material; ignored if a modulus is given
  std::string youngs_modulus;         ///< E of an unnamed material, which needs `density` too
  std::string density;  ///< density of an unnamed material; ignored without `youngs_modulus`
  /// Direction of the clamp at arc length 0; an angle is measured from +x to the upward axis.
  std::string direction = "0 deg";
  std::string up = "y";  ///< upward axis, opposite to gravity: "y" or "z"
};

/// Returns a scene file of one clamp at the origin, with every key of scene_tables(), its words,
/// its units and what is allowed. Lines that begin with # and no blank are optional parts; the file
/// of a slender rod is valid with any of these paragraphs, and with all of them, uncommented.
/// @throws InputError that names rod.length and the like, as reading the file does, also for a rod
/// that is thicker than long
[[nodiscard]] std::string scene_text(const SceneChoices& choices,
                                     const std::vector<Material>& known_materials = materials());

}  // namespace dlo::compare
