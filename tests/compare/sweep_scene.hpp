#pragma once

#include <string>
#include <vector>

#include "../helpers.hpp"
#include "batch/sweep.hpp"
#include "scene_text.hpp"

namespace dlo::test {

inline const std::string sweep_scene = "name = \"swept\"\n" + steel_rod + level_clamp;

inline compare::Sweep sweep(const std::vector<std::string>& vary,
                            compare::SweepModel model = compare::SweepModel::energy,
                            const std::string& scene = sweep_scene) {
  std::vector<compare::Axis> axes;
  axes.reserve(vary.size());
  for (const std::string& text : vary) axes.push_back(compare::parse_axis(text));
  return {compare::SceneTemplate(scene, "swept.toml"), compare::Grid(axes), model};
}

}  // namespace dlo::test
