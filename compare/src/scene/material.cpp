#include "dlo/compare/material.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "scene/builtin_data.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {

std::vector<Material> read_materials(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  // The others are of what calibrate writes, for --calibrated.
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

LayeredSection layered_section(const std::vector<Layer>& layers) {
  LayeredSection sum;
  int number = 0;
  const auto refuse = [&number](const std::string& problem) {
    throw InputError(fmt::format("layer {}: {}", number, problem));
  };
  for (const Layer& layer : layers) {
    ++number;
    const double E = layer.youngs_modulus;
    const double G = E / (2 * (1 + assumed_poisson_ratio));
    const double within = sum.outer_diameter;
    const double d = layer.strand_diameter;
    double area = 0;
    if (layer.strands == 0) {
      const double outer = layer.outer_diameter;
      if (!(outer > within)) {
        refuse(
            fmt::format("outer_diameter = {:g} m, what is within it is {:g} m thick (allowed: "
                        "more)",
                        outer, within));
      }
      area = std::numbers::pi / 4 * (outer * outer - within * within);
      const double I = std::numbers::pi / 64 * (std::pow(outer, 4) - std::pow(within, 4));
      sum.bonded_bending_stiffness += E * I;
      sum.free_bending_stiffness += E * I;
      sum.bonded_torsional_stiffness += 2 * G * I;
      sum.free_torsional_stiffness += 2 * G * I;
      sum.outer_diameter = outer;
    } else {
      const bool core = layer.strands == 1;
      if (layer.strands == 2 || (core && within > 0)) {
        refuse(
            fmt::format("{} strand{} do{} not bend alike about all axes (allowed: 3 or more, or "
                        "1 as the first layer)",
                        layer.strands, core ? "" : "s", core ? "es" : ""));
      }
      const double share = core ? 0 : std::sin(std::numbers::pi / layer.strands);
      const double ring = core ? 0 : within > 0 ? (within + d) / 2 : d / (2 * share);
      constexpr double rounding = 1e-9;
      if (!core && d > 2 * ring * share * (1 + rounding)) {
        refuse(
            fmt::format("{} strands of {:g} m do not fit side by side on {:g} m (allowed: fewer, "
                        "or thinner ones)",
                        layer.strands, d, within));
      }
      const double one = std::numbers::pi / 4 * d * d;
      area = layer.strands * one;
      const double own = area * d * d / 16;
      const double apart = area * ring * ring / 2;
      sum.bonded_bending_stiffness += E * (own + apart);
      sum.free_bending_stiffness += E * own;
      sum.bonded_torsional_stiffness += 2 * G * (own + apart);
      sum.free_torsional_stiffness += 2 * G * own;
      sum.outer_diameter = 2 * ring + d;
    }
    sum.axial_stiffness += E * area;
    sum.mass_per_length += layer.density * area;
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
