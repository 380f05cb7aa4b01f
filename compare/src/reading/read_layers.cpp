#include <fmt/format.h>

#include <string>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

Layer read_layer(StrictTable& table, const std::vector<Material>& known_materials) {
  table.only(scene_keys("layers"));
  Layer layer;
  if (table.has("material")) {
    const Material material = read_material(table, known_materials);
    layer.youngs_modulus = material.youngs_modulus;
    layer.density = material.density;
  }
  const bool known = layer.youngs_modulus > 0;
  if (!known || table.has("youngs_modulus")) {
    layer.youngs_modulus = table.number("youngs_modulus", Dimension::pressure, Range::positive());
  }
  if (!known || table.has("density")) {
    layer.density = table.number("density", Dimension::density, Range::not_negative());
  }
  const Range size = Range::between(1e-9, 1e3, " m");
  if (table.has("strands") || table.has("strand_diameter")) {
    if (table.has("outer_diameter")) {
      table.fail("outer_diameter",
                 "given besides strands, which say it (allowed: outer_diameter, or strands and "
                 "strand_diameter)");
    }
    constexpr int most = 10'000;
    layer.strands = table.integer("strands", 1, most);
    layer.strand_diameter = table.number("strand_diameter", Dimension::length, size);
  } else {
    layer.outer_diameter = table.number("outer_diameter", Dimension::length, size);
  }
  table.finish();
  return layer;
}

}  // namespace

Material read_material(StrictTable& rod, const std::vector<Material>& known_materials) {
  if (rod.is_table("material")) {
    StrictTable own = rod.table("material");
    own.only(scene_keys("material"));
    Material material{.name = "own", .source = "scene file"};
    material.youngs_modulus = own.number("youngs_modulus", Dimension::pressure, Range::positive());
    material.density = own.number("density", Dimension::density, Range::not_negative());
    own.finish();
    return material;
  }
  const std::string name = rod.text("material");
  std::vector<std::string> names;
  for (const Material& material : known_materials) {
    if (material.name == name) return material;
    names.push_back(material.name);
  }
  rod.fail("material",
           fmt::format("unknown material{} (allowed: {}, or a table such as {{ youngs_modulus = "
                       "\"5 MPa\", density = 1100 }}; dlo materials lists them with values)",
                       did_you_mean(name, names), fmt::join(names, ", ")));
}

bool read_layers(StrictTable& rod, const std::vector<Material>& known_materials, Scene& scene) {
  if (!rod.has("layers")) {
    if (rod.has("layer_bound")) {
      rod.fail("layer_bound", "the rod has no layers (allowed: rod.layers too, or no layer_bound)");
    }
    return false;
  }
  for (const char* key :
       {"diameter", "inner_diameter", "width", "thickness", "material", "bending_stiffness",
        "mass_per_length", "joint_stiffness", "joint_spacing"}) {
    if (!rod.has(key)) continue;
    rod.fail(key, "given besides layers, which say it (allowed: one of the two)");
  }
  constexpr std::size_t most = 100;
  std::vector<StrictTable> tables = rod.tables("layers");
  if (tables.empty() || tables.size() > most) {
    rod.fail("layers", fmt::format("{} layers (allowed: 1 to {}, such as [{{ outer_diameter = \"2 "
                                   "mm\", material = \"copper\" }}])",
                                   tables.size(), most));
  }
  std::vector<Layer> layers;
  layers.reserve(tables.size());
  for (StrictTable& table : tables) layers.push_back(read_layer(table, known_materials));
  LayeredSection section;
  try {
    section = layered_section(layers);
  } catch (const InputError& error) {
    rod.fail("layers", error.what());
  }
  section.bonded =
      !rod.has("layer_bound") || rod.choice("layer_bound", {"bonded", "free"}) == "bonded";
  scene.diameter = section.outer_diameter;
  const double area = scene.cross_section();
  scene.material = {.name = "layers",
                    .youngs_modulus = section.axial_stiffness / area,
                    .density = section.mass_per_length / area,
                    .source = "scene file"};
  scene.given_bending_stiffness =
      section.bonded ? section.bonded_bending_stiffness : section.free_bending_stiffness;
  scene.given_mass_per_length = section.mass_per_length;
  scene.torsional_stiffness =
      section.bonded ? section.bonded_torsional_stiffness : section.free_torsional_stiffness;
  scene.layers = section;
  return true;
}

}  // namespace dlo::compare
