#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// A point of a rod's shape that a formula gives.
struct ClosedForm {
  std::string is;         ///< the formula, or the curve, in words
  double at = 0;          ///< arc length [m]
  Eigen::Vector3d point;  ///< where the rod is there [m]
};

/// A motion that a scene begins: it is let go at 0 s from the equilibrium of another one.
struct BatteryMotion {
  Scene begin;       ///< the same rod as something holds it before, at rest
  double until = 0;  ///< [s], > 0
  int frames = 0;    ///< that are asked for, at equal distances from 0 to `until`

  /// [s]
  [[nodiscard]] std::vector<double> times() const;
};

/// A scene of the battery.
struct BatteryScene {
  std::string id;                         ///< the stem of its file
  std::string group;                      ///< its class: "weight", "twist"
  std::string isolates;                   ///< one line: what it isolates
  std::optional<ClosedForm> closed_form;  ///< where there is one
  std::optional<BatteryMotion> motion;    ///< none: it is at rest
  Scene scene;                            ///< as its file has it
};

/// Scenes that a simulator is run on.
struct Battery {
  std::string version;               ///< grows when a scene changes
  std::vector<BatteryScene> scenes;  ///< by classes, in the file's order
};

/// That of data/suite, which is compiled into the library.
[[nodiscard]] const Battery& builtin_battery();

/// The text of the file of one of its scenes. @throws InputError if it is none
[[nodiscard]] std::string builtin_scene_text(const Scene& scene);

/// Of a TOML file with schema = "dlo/suite/1", as data/suite/suite.toml is, and the scenes beside
/// it. @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Battery load_battery(const std::string& path);

/// The scenes of the classes, or with the ids, that are asked for, in the battery's order.
/// @param wanted  none: all
/// @throws InputError naming what there is neither a class nor a scene of
[[nodiscard]] std::vector<BatteryScene> chosen_scenes(const Battery& battery,
                                                      const std::vector<std::string>& wanted);

/// The JSON Schema of an answer.
[[nodiscard]] std::string_view answer_schema();
[[nodiscard]] std::string_view motion_schema();  ///< of a motion's

}  // namespace dlo::compare
