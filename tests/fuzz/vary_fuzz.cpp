// Any --vary is an axis whose values the scene takes, or an InputError.

#include <cstddef>
#include <cstdint>
#include <string>

#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_template.hpp"
#include "dlo/compare/sweep_grid.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const dlo::compare::SceneTemplate scene(R"(gravity = [0, -9.81, 0]
[rod]
length = 1
diameter = 0.002
material = "copper"
[[gripper]]
at = 0
position = [0, 0, 0]
direction = "0 deg"
)",
                                                 "fuzz.toml");
  try {
    const dlo::compare::Axis axis = dlo::compare::parse_axis(std::string(data, data + size));
    for (const std::int64_t index : {std::int64_t{0}, axis.count / 2, axis.count - 1}) {
      (void)scene.with({{axis.field, axis.value(index)}});
    }
  } catch (const dlo::compare::InputError&) {
    return 0;
  }
  return 0;
}
