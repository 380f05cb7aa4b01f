#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Point of a rod's shape that is known in closed form.
struct ClosedForm {
  std::string is;         ///< the formula or the curve, in words
  double at = 0;          ///< arc length [m]
  Eigen::Vector3d point;  ///< position of the rod there [m]
};

/// Motion of a scene: the rod is released at 0 s from the equilibrium of another scene.
struct BatteryMotion {
  Scene begin;       ///< the same rod with what holds it before 0 s, at rest
  double until = 0;  ///< end time [s], > 0
  int frames = 0;    ///< number of requested frames, at equal intervals from 0 to `until`

  /// Returns the times of the frames [s].
  [[nodiscard]] std::vector<double> times() const;
};

/// Scene of the benchmark set.
struct BatteryScene {
  std::string id;                         ///< stem of its file name
  std::string group;                      ///< class of the scene, such as "weight" or "twist"
  std::string isolates;                   ///< one line: the effect that it isolates
  std::optional<ClosedForm> closed_form;  ///< empty if there is none
  std::optional<BatteryMotion> motion;    ///< empty if the scene is at rest
  Scene scene;                            ///< the content of its file
};

/// Benchmark set: scenes on which a simulator is run.
struct Battery {
  std::string version;               ///< increases whenever a scene changes
  std::vector<BatteryScene> scenes;  ///< by classes, in the order of the file
};

/// Returns the set of data/suite, which is compiled into the library.
[[nodiscard]] const Battery& builtin_battery();

/// Returns the text of the file of one of its scenes. @throws InputError if the scene is none of
/// them
[[nodiscard]] std::string builtin_scene_text(const Scene& scene);

/// Reads a set from a TOML file with schema = "dlo/suite/1", such as data/suite/suite.toml, and the
/// scenes next to it. @throws InputError naming file, line, key, value and what is allowed
[[nodiscard]] Battery load_battery(const std::string& path);

/// Returns the scenes of the requested classes, or with the requested ids, in the order of the set.
/// @param wanted  classes and ids; empty: all scenes
/// @throws InputError naming an entry that is neither a class nor an id
[[nodiscard]] std::vector<BatteryScene> chosen_scenes(const Battery& battery,
                                                      const std::vector<std::string>& wanted);

/// Returns the JSON Schema of an answer.
[[nodiscard]] std::string_view answer_schema();
[[nodiscard]] std::string_view motion_schema();  ///< JSON Schema of a motion's answer

}  // namespace dlo::compare
