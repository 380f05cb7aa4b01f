#include "dlo/compare/scene_file.hpp"

#include "base/input_file.hpp"
#include "scene/builtin_data.hpp"
#include "scene/read_scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

Scene parse_scene(const std::string& text, const std::string& file,
                  const std::vector<Material>& known_materials) {
  return read_scene(parse_toml(text, file), file, known_materials);
}

Scene load_scene(const std::string& path, const std::vector<Material>& known_materials) {
  return parse_scene(read_file(path), path, known_materials);
}

std::vector<Scene> paper_scenes() {
  return {
      parse_scene(std::string(builtin::spring_steel_135_toml), "data/scenes/spring_steel_135.toml"),
      parse_scene(std::string(builtin::spring_steel_175_toml), "data/scenes/spring_steel_175.toml"),
      parse_scene(std::string(builtin::spring_steel_215_toml),
                  "data/scenes/spring_steel_215.toml")};
}

}  // namespace dlo::compare
