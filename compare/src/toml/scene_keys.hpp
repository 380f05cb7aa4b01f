#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A table of a scene file and what it may have.
struct SceneTable {
  std::string name;  ///< "rod", "gripper"; "" of the file itself, "material" of a rod's own
  std::vector<std::string> keys;  ///< by the alphabet
};

/// All tables of a scene file but those of poses.
[[nodiscard]] const std::vector<SceneTable>& scene_tables();

/// What one of them may have. @throws std::out_of_range for another name
[[nodiscard]] const std::vector<std::string>& scene_keys(std::string_view table);

}  // namespace dlo::compare
