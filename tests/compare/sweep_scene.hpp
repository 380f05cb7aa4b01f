#pragma once

#include <string>
#include <vector>

#include "batch/sweep.hpp"

namespace dlo::test {

inline constexpr const char* sweep_scene = R"(name = "swept"
[rod]
length = "50 cm"
diameter = "2 mm"
material = "spring_steel"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)";

inline compare::Sweep sweep(const std::vector<std::string>& vary,
                            compare::SweepModel model = compare::SweepModel::energy,
                            const std::string& scene = sweep_scene) {
  std::vector<compare::Axis> axes;
  axes.reserve(vary.size());
  for (const std::string& text : vary) axes.push_back(compare::parse_axis(text));
  return {compare::SceneTemplate(scene, "swept.toml"), compare::Grid(axes), model};
}

}  // namespace dlo::test
