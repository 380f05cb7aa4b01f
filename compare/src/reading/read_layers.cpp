#include <fmt/format.h>

#include <string>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

Layer read_layer(StrictTable& table, const std::vector<Material>& known_materials) {
  Layer layer;
  if (table.has("material")) {
    const Material material = read_material(table, known_materials);
    layer.youngs_modulus = material.youngs_modulus;
    layer.density = material.density;
  }
  const bool known = layer.youngs_modulus > 0;
  if (!known || table.has("youngs_modulus")) layer.youngs_modulus = table.number("youngs_modulus");
  if (!known || table.has("density")) layer.density = table.number("density");
  if (table.read("strands", layer.strands)) {
    layer.strand_diameter = table.number("strand_diameter");
  } else {
    layer.outer_diameter = table.number("outer_diameter");
  }
  table.finish();
  return layer;
}

}  // namespace

Material read_material(StrictTable& rod, const std::vector<Material>& known_materials) {
  if (rod.is("material", toml::node_type::table)) {
    StrictTable own = rod.table("material");
    const Material material{.name = "own",
                            .youngs_modulus = own.number("youngs_modulus"),
                            .density = own.number("density"),
                            .source = "scene file"};
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
  std::vector<StrictTable> tables = rod.tables("layers");
  if (!rod.has("layers")) return false;
  std::vector<Layer> layers;
  layers.reserve(tables.size());
  for (StrictTable& table : tables) layers.push_back(read_layer(table, known_materials));
  LayeredSection section;
  try {
    section = layered_section(layers);
  } catch (const InputError& error) {
    rod.fail("layers", error.what());
  }
  section.bonded = rod.choice("layer_bound") == "bonded";
  scene.diameter = section.outer_diameter;
  const double area = scene.cross_section();
  scene.material = {.name = "layers",
                    .youngs_modulus = section.axial_stiffness / area,
                    .density = section.mass_per_length / area,
                    .source = "scene file"};
  scene.given_bending_stiffness =
      section.bonded ? section.bonded_bending_stiffness : section.free_bending_stiffness;
  scene.given_mass_per_length = section.mass_per_length;
  if (!scene.torsional_stiffness) {
    scene.torsional_stiffness =
        section.bonded ? section.bonded_torsional_stiffness : section.free_torsional_stiffness;
  }
  scene.layers = section;
  return true;
}

}  // namespace dlo::compare
