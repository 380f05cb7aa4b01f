#include <algorithm>
#include <stdexcept>

#include "toml/strict_table.hpp"

namespace dlo::compare {

const std::vector<SceneTable>& scene_tables() {
  static const std::vector<SceneTable> tables = {
      {"",
       {"distributed_load", "force_model", "gravity", "gripper", "load", "medium", "name",
        "obstacle", "rod", "section", "track"}},
      {"rod",
       {"axial_stiffness", "bending_stiffness", "diameter", "helix", "inner_diameter",
        "joint_spacing", "joint_stiffness", "layer_bound", "layers", "length", "mass_per_length",
        "material", "natural_curvature", "natural_twist", "rest_shape", "stretch", "thickness",
        "torsional_stiffness", "width"}},
      {"helix", {"pitch", "radius"}},
      {"layers",
       {"density", "material", "outer_diameter", "strand_diameter", "strands", "youngs_modulus"}},
      {"medium", {"density", "normal_drag", "tangential_drag", "velocity"}},
      {"material", {"density", "youngs_modulus"}},
      {"gripper",
       {"at", "cutoff", "direction", "frame", "hold", "pose", "position", "quaternion", "roll",
        "trajectory", "turns"}},
      {"load", {"at", "follows", "force", "mass", "torque"}},
      {"distributed_load", {"force_per_length", "from", "to"}},
      {"obstacle",
       {"axis", "cutoff", "friction", "length", "normal", "point", "pose", "radius", "shape",
        "size", "stiffness", "touches", "trajectory"}},
      {"section",
       {"bending_stiffness", "from", "mass_per_length", "natural_curvature", "natural_twist", "to",
        "torsional_stiffness"}},
      {"force_model",
       {"bending_rule", "bookkeeping", "c_F", "c_b", "c_c", "c_h", "design_curvature", "joint_law",
        "l_s", "law", "point_weight", "points", "stepper"}},
      {"track", {"frame_rate", "obstacle_rate", "start", "step_rate"}}};
  return tables;
}

const std::vector<std::string>& scene_keys(std::string_view table) {
  const std::vector<SceneTable>& all = scene_tables();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const SceneTable& one) { return one.name == table; });
  if (found == all.end()) throw std::out_of_range("no table " + std::string(table));
  return found->keys;
}

}  // namespace dlo::compare
