#include "dlo/compare/material.hpp"

#include "base/input_file.hpp"
#include "scene/builtin_data.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

std::vector<Material> read_materials(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  std::vector<Material> result;
  for (StrictTable& entry : table.tables("material")) {
    Material material;
    entry.only({"density", "name", "source", "youngs_modulus"});
    material.name = entry.text("name");
    material.youngs_modulus =
        entry.number("youngs_modulus", Dimension::pressure, Range::positive());
    material.density = entry.number("density", Dimension::density, Range::positive());
    material.source = entry.text("source");
    entry.finish();
    result.push_back(std::move(material));
  }
  table.finish();
  return result;
}

std::vector<Material> load_materials(const std::string& path) {
  return read_materials(read_file(path), path);
}

const std::vector<Material>& materials() {
  static const std::vector<Material> builtin =
      read_materials(std::string(builtin::materials_toml), "data/materials.toml");
  return builtin;
}

}  // namespace dlo::compare
