#include "dlo/compare/material.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/builtin_data.hpp"
#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

std::vector<Material> read_materials(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  // The other keys are written by calibrate, for --calibrated.
  table.only({"gripper", "material", "natural_curvature", "torsional_stiffness"});
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
  return result;
}

namespace {

double shear_modulus(const Layer& layer) {
  return layer.youngs_modulus / (2 * (1 + assumed_poisson_ratio));
}

/// Adds a solid or hollow layer around `sum`.
/// @return the area of its section in m^2
double add_tube(const Layer& layer, LayeredSection& sum) {
  const double inner = sum.outer_diameter;
  const double outer = layer.outer_diameter;
  if (!(outer > inner)) {
    throw InputError(
        fmt::format("outer_diameter = {:g} m, the layers inside are {:g} m thick (allowed: more)",
                    outer, inner));
  }
  const double I = std::numbers::pi / 64 * (std::pow(outer, 4) - std::pow(inner, 4));
  sum.bonded_bending_stiffness += layer.youngs_modulus * I;
  sum.free_bending_stiffness += layer.youngs_modulus * I;
  sum.bonded_torsional_stiffness += 2 * shear_modulus(layer) * I;
  sum.free_torsional_stiffness += 2 * shear_modulus(layer) * I;
  sum.outer_diameter = outer;
  return std::numbers::pi / 4 * (outer * outer - inner * inner);
}

/// Adds a ring of strands around `sum`, or one strand as the core.
/// @return the area of their sections in m^2
double add_strands(const Layer& layer, LayeredSection& sum) {
  const double inner = sum.outer_diameter;
  const double d = layer.strand_diameter;
  const bool core = layer.strands == 1;
  if (layer.strands < 0) {
    throw InputError(fmt::format("strands = {} (allowed: 0 or more)", layer.strands));
  }
  if (layer.strands == 2 || (core && inner > 0)) {
    throw InputError(
        fmt::format("{} strand{} do{} not bend alike about all axes (allowed: 3 or more, or 1 as "
                    "the first layer)",
                    layer.strands, core ? "" : "s", core ? "es" : ""));
  }
  const double share = core ? 0 : std::sin(std::numbers::pi / layer.strands);
  const double ring = core ? 0 : inner > 0 ? (inner + d) / 2 : d / (2 * share);
  constexpr double rounding = 1e-9;
  if (!core && d > 2 * ring * share * (1 + rounding)) {
    throw InputError(fmt::format(
        "{} strands of {:g} m do not fit side by side on {:g} m (allowed: fewer, or thinner ones)",
        layer.strands, d, inner));
  }
  const double area = layer.strands * std::numbers::pi / 4 * d * d;
  const double centroid_term = area * d * d / 16;
  const double steiner_term = area * ring * ring / 2;
  sum.bonded_bending_stiffness += layer.youngs_modulus * (centroid_term + steiner_term);
  sum.free_bending_stiffness += layer.youngs_modulus * centroid_term;
  sum.bonded_torsional_stiffness += 2 * shear_modulus(layer) * (centroid_term + steiner_term);
  sum.free_torsional_stiffness += 2 * shear_modulus(layer) * centroid_term;
  sum.outer_diameter = 2 * ring + d;
  return area;
}

}  // namespace

LayeredSection layered_section(const std::vector<Layer>& layers) {
  LayeredSection sum;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    try {
      const double area = layer.strands == 0 ? add_tube(layer, sum) : add_strands(layer, sum);
      sum.axial_stiffness += layer.youngs_modulus * area;
      sum.mass_per_length += layer.density * area;
    } catch (const InputError& error) {
      throw InputError(fmt::format("layer {}: {}", i + 1, error.what()));
    }
  }
  return sum;
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
