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
/// are made a scene's; Scene::model says what was assumed.
/// @param file  its name, for messages and Scene::file
/// @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Scene parse_scene(const std::string& text, const std::string& file,
                                const std::vector<Material>& known_materials = materials());

/// Reads a scene file. @throws InputError as parse_scene, or if it cannot be read
[[nodiscard]] Scene load_scene(const std::string& path,
                               const std::vector<Material>& known_materials = materials());

/// What a field of a scene is in code: a number in SI units, text, such as with a unit, or a list
/// of these.
class SceneValue {
 public:
  /// Of any type of number.
  template <typename Number>
  requires std::is_arithmetic_v<Number> SceneValue(Number number)
      : SceneValue(of_number(static_cast<double>(number))) {}
  /// "5 cm", "copper"
  SceneValue(const char* text) : text_(text) {}
  /// The same.
  SceneValue(std::string text) : text_(std::move(text)) {}
  /// {0, "5 cm", 0}
  SceneValue(std::initializer_list<SceneValue> list);
  /// A place in m, a direction, a force in N.
  SceneValue(const Eigen::Vector3d& vector) : SceneValue{vector.x(), vector.y(), vector.z()} {}

  /// As a scene file has it, quotes not needed.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string of_number(double number);

  std::string text_;
};

/// A field of a scene and the value it gets.
struct SceneField {
  std::string field;  ///< dotted path; of several by number from 0, as in gripper.0.direction
  SceneValue value;   ///< what a file may say there
};

/// A scene made in code, by the fields of a scene file and held to the same:
///     make_scene({{"rod.length", "30 cm"}, {"rod.diameter", 0.5e-3}, {"rod.material", "copper"},
///                 {"gripper.0.at", 0}, {"gripper.0.position", {0, 0, 0}},
///                 {"gripper.0.direction", "30 deg"}})
/// @param file  its name, for messages and Scene::file
/// @throws InputError naming field, value and what is allowed
[[nodiscard]] Scene make_scene(const std::vector<SceneField>& fields,
                               const std::string& file = "scene");

/// The three scenes of the paper's Figs. 12 and 13, built into the library (data/scenes).
[[nodiscard]] std::vector<Scene> paper_scenes();

}  // namespace dlo::compare
