#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "reading/read_parts.hpp"
#include "scene/members.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

/// Largest w l^3 / (EI): beyond it no solver resolves the boundary layer at a clamp, and the shape
/// of the rod no longer changes visibly.
constexpr double largest_gamma = 1e12;
/// Distance of adjacent sections that counts as rounding of units, divided by the length [-].
constexpr double adjacent_rounding_share = 1e-12;

/// EI about every axis of the cross-section, or about d1 and d2.
struct BendingStiffnesses {
  double about_d1;
  std::optional<double> about_d2;
};

std::optional<BendingStiffnesses> read_bending_stiffness(StrictTable& table) {
  constexpr const char* key = "bending_stiffness";
  if (!table.has(key)) return std::nullopt;
  if (!table.is(key, toml::node_type::array))
    return BendingStiffnesses{table.number(key), std::nullopt};
  const Eigen::Vector2d pair = table.pair(key);
  return BendingStiffnesses{pair.x(), pair.y()};
}

/// Reads EI of a rod that is given by its EI, or by the joints of a chain; std::nullopt if neither
/// is given.
std::optional<BendingStiffnesses> read_bending(StrictTable& rod, double length) {
  if (!rod.has("joint_stiffness")) return read_bending_stiffness(rod);
  const Range spacing = Range::between(1e-6 * length, length, " m");
  return BendingStiffnesses{
      rod.number("joint_stiffness") * rod.number("joint_spacing", Dimension::length, spacing),
      std::nullopt};
}

/// Reads what a circle or a ring has in addition to its diameter, which is required; nothing for a
/// rectangle.
void read_cross_section(StrictTable& rod, Scene& scene) {
  if (rod.has("width")) return;
  (void)rod.number("diameter");  // required
  const Range bore{0, std::nextafter(scene.diameter, 0), false,
                   fmt::format("0 to less than diameter, {:g} m", scene.diameter)};
  scene.inner_diameter = rod.optional_number("inner_diameter", Dimension::length, bore).value_or(0);
}

/// Reads bending stiffness and mass: given values, or material and section.
void read_stiffness(StrictTable& rod, const std::vector<Material>& known_materials, Scene& scene) {
  if (const std::optional<BendingStiffnesses> given = read_bending(rod, scene.length)) {
    scene.given_bending_stiffness = given->about_d1;
    scene.given_bending_stiffness_2 = given->about_d2;
  }
  const bool has_bending = scene.given_bending_stiffness.has_value();
  const bool has_mass = rod.has("mass_per_length");
  const bool has_material = rod.has("material");
  if (!has_material && has_bending != has_mass) {
    const char* bending = rod.has("joint_stiffness") ? "joint_stiffness" : "bending_stiffness";
    rod.fail(has_bending ? "mass_per_length" : "bending_stiffness",
             fmt::format("missing, it is required beside {} (allowed: both, or material and "
                         "diameter too)",
                         has_bending ? bending : "mass_per_length"));
  }
  const bool complete = has_bending && has_mass && !has_material;
  const bool has_section =
      rod.has("diameter") || rod.has("inner_diameter") || rod.has("width") || rod.has("thickness");
  if (has_bending && has_mass && has_material && !has_section) {
    rod.fail(
        "diameter",
        "missing, the material has no effect without it (allowed: a diameter, or no material)");
  }
  if (!complete || has_section) read_cross_section(rod, scene);
  if (!complete) scene.material = read_material(rod, known_materials);
}

std::string section_text(const Scene& scene) {
  if (scene.width > 0) {
    return fmt::format("width = {:g} m, thickness = {:g} m", scene.width, scene.thickness);
  }
  return fmt::format("diameter = {:g} m", scene.diameter);
}

/// Checks that stiffnesses derived from numbers in range are positive and finite, and that Gamma is
/// at most largest_gamma.
void require_finite_rod(const Scene& scene, const StrictTable& rod) {
  const auto usable = [](double stiffness) { return stiffness > 0 && std::isfinite(stiffness); };
  if (!usable(scene.bending_stiffness()) || !usable(scene.axial_stiffness())) {
    if (rod.has("material")) {
      rod.fail("material",
               fmt::format("E I = {:g} N m^2, E A = {:g} N (allowed: numbers > 0 that are "
                           "finite), with {} and E = {:g} Pa",
                           scene.bending_stiffness(), scene.axial_stiffness(), section_text(scene),
                           scene.material.youngs_modulus));
    }
    rod.fail("bending_stiffness",
             fmt::format("E A = {:g} N of such a rod (allowed: a number > 0 that is finite), with "
                         "{} and length = {:g} m",
                         scene.axial_stiffness(), section_text(scene), scene.length));
  }
  // The negated condition also rejects NaN.
  if (!(scene.gamma() <= largest_gamma)) {
    rod.fail("length",
             fmt::format("Gamma = w l^3 / (EI) = {:.4g} (allowed: 0 to {:g}), with w = {:.4g} N/m "
                         "and E I = {:.4g} N m^2",
                         scene.gamma(), largest_gamma, scene.weight_per_length().norm(),
                         scene.softer_bending_stiffness()));
  }
}

Section read_section(StrictTable& table, const Scene& scene) {
  Section section;
  section.from = read_arc_length(table, "from", scene.length);
  section.to = read_arc_length(table, "to", scene.length);
  if (!(section.to > section.from)) {
    table.fail("to", fmt::format("not behind from = {:g} m (allowed: more, up to {:g} m)",
                                 section.from, scene.length));
  }
  const BendingStiffnesses bending = read_bending_stiffness(table).value_or(
      BendingStiffnesses{scene.bending_stiffness(), scene.bending_stiffness_2()});
  section.bending_stiffness = bending.about_d1;
  section.bending_stiffness_2 = bending.about_d2;
  section.mass_per_length = scene.mass_per_length();
  read_members(table, section);
  const bool has_ends_alone = table.keys().size() == 2;
  if (has_ends_alone) {
    table.fail("bending_stiffness",
               "missing, and so are mass_per_length, torsional_stiffness, natural_curvature and "
               "natural_twist (allowed: one of the five or more; the others are the rod's own)");
  }
  if (section.torsional_stiffness && !scene.torsional_stiffness) {
    table.fail("torsional_stiffness",
               "the rod has none (allowed: rod.torsional_stiffness too, or none here)");
  }
  table.finish();
  return section;
}

void read_sections(std::vector<StrictTable>& tables, Scene& scene) {
  std::vector<std::size_t> along;
  std::vector<Section> sections;
  for (StrictTable& table : tables) {
    along.push_back(sections.size());
    sections.push_back(read_section(table, scene));
  }
  std::ranges::stable_sort(along, {}, [&](std::size_t i) { return sections[i].from; });
  for (const std::size_t i : along) {
    if (!scene.sections.empty()) {
      const double before = scene.sections.back().to;
      if (std::abs(sections[i].from - before) <= adjacent_rounding_share * scene.length) {
        sections[i].from = before;
      }
      if (sections[i].from < before) {
        tables[i].fail("from", fmt::format("inside the section from {:g} to {:g} m (allowed: "
                                           "sections that do not overlap)",
                                           scene.sections.back().from, before));
      }
    }
    scene.sections.push_back(sections[i]);
  }
}

/// @param scene  scene whose EA has been read
void read_stretch(StrictTable& rod, Scene& scene) {
  const bool automatic =
      rod.is("stretch", toml::node_type::string) && rod.text("stretch") == "auto";
  if (rod.has("stretch") && !automatic && !rod.is("stretch", toml::node_type::boolean)) {
    rod.fail("stretch", "unknown (allowed: true, false or \"auto\")");
  }
  if (automatic || rod.flag("stretch")) {
    scene.stretch = automatic ? Stretch::automatic : Stretch::counted;
  }
  if (scene.stretch != Stretch::none && !scene.known_axial_stiffness()) {
    rod.fail("stretch",
             "EA is not known (allowed: axial_stiffness, or material and section, or false)");
  }
}

}  // namespace

void read_rod(StrictTable& rod, std::vector<StrictTable>& sections,
              const std::vector<Material>& known_materials, Scene& scene) {
  read_members(rod, scene);
  if (!read_layers(rod, known_materials, scene)) read_stiffness(rod, known_materials, scene);
  read_stretch(rod, scene);
  read_natural_strains(rod, scene);
  read_sections(sections, scene);
  read_rest_shape(rod, sections, scene);
  require_finite_rod(scene, rod);
  rod.finish();
}

}  // namespace dlo::compare
