#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "dlo/compare/material.hpp"
#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Reads a scene: TOML, or a MuJoCo model (MJCF) of one cable, whose rod, grippers and obstacles
/// become those of the scene; Scene::model lists what was assumed.
/// @param file  name of the file, for messages and Scene::file
/// @throws InputError that names file, line, key, value and what is allowed
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& file,
                                const std::vector<Material>& known_materials = materials());

/// Reads a scene file. @throws InputError as parse_scene, or if it cannot be read
[[nodiscard]] Scene load_scene(const std::string& path,
                               const std::vector<Material>& known_materials = materials());

/// Value of a scene's field in code: a number in SI units, a text, such as a number with a unit, or
/// a list of these. Fields that are true or false cannot be given.
class SceneValue {
 public:
  /// Converts any arithmetic type, in SI units.
  template <typename Number>
  requires std::is_arithmetic_v<Number> SceneValue(Number number)
      : SceneValue(number_text(static_cast<double>(number))) {}
  /// Takes a text as in a scene file: "5 cm", "copper".
  SceneValue(const char* text) : text_(text) {}
  /// Takes a text as in a scene file: "5 cm", "copper".
  SceneValue(std::string text) : text_(std::move(text)) {}
  /// Takes a list: {0, "5 cm", 0}.
  SceneValue(std::initializer_list<SceneValue> list);
  /// Takes a vector: a position in m, a direction, a force in N.
  SceneValue(const Eigen::Vector3d& vector) : SceneValue{vector.x(), vector.y(), vector.z()} {}

  /// Returns the value as a scene file would contain it, but a text without its quotes.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string number_text(double number);

  std::string text_;
};

/// A field of a scene and the value it gets.
struct SceneField {
  /// Dotted path; elements of a list by number from 0, as in gripper.0.direction.
  std::string field;
  SceneValue value;  ///< value as in a scene file
};

/// Makes a scene in code from the fields of a scene file, with the same checks:
///     make_scene({{"rod.length", "30 cm"}, {"rod.diameter", 0.5e-3}, {"rod.material", "copper"},
///                 {"gripper.0.at", 0}, {"gripper.0.position", {0, 0, 0}},
///                 {"gripper.0.direction", "30 deg"}})
/// @param file  name of the scene in messages and Scene::file
/// @throws InputError that names field, value and what is allowed
[[nodiscard]] Scene make_scene(const std::vector<SceneField>& fields,
                               const std::string& file = "scene");

/// Returns the three scenes of the paper's Figs. 12 and 13, built into the library (data/scenes).
[[nodiscard]] std::vector<Scene> paper_scenes();

}  // namespace dlo::compare
