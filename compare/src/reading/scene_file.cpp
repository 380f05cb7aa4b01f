#include "dlo/compare/scene_file.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/builtin_data.hpp"
#include "base/input_file.hpp"
#include "decode/xml.hpp"
#include "mjcf/mjcf_scene.hpp"
#include "reading/read_scene.hpp"
#include "toml/strict_table.hpp"

#define XXH_INLINE_ALL  // header-only, nothing to link
#include <xxhash.h>

namespace dlo::compare {

SceneSource parse_scene_source(const std::string& text, const std::string& file) {
  if (!looks_like_xml(text)) return {parse_toml(text, file), file, file, std::nullopt};
  MjcfScene made = mjcf_scene(text, file);
  const std::string where = file + ", as a scene";
  return {parse_toml(made.text, where), where, file, std::move(made.chain)};
}

Scene read_scene(const SceneSource& source, const std::vector<Material>& known_materials) {
  Scene scene = read_scene(source.root, source.where, known_materials);
  scene.file = source.file;
  scene.model = source.model;
  return scene;
}

Scene parse_scene(const std::string& text, const std::string& file,
                  const std::vector<Material>& known_materials) {
  return read_scene(parse_scene_source(text, file), known_materials);
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

std::string fingerprint(const std::string& text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace dlo::compare
