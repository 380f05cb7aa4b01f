#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "reading/read_parts.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

/// Largest w l^3 / (EI): beyond it no solver resolves the boundary layer at a clamp, and the shape
/// of the rod no longer changes visibly.
constexpr double largest_gamma = 1e12;
/// Distance of adjacent sections that counts as rounding of units, divided by the length [-].
constexpr double same_place_share = 1e-12;

/// EI about every axis of the cross-section, or about d1 and d2.
struct GivenBending {
  double about_d1;
  std::optional<double> about_d2;
};

std::optional<GivenBending> read_bending_stiffness(StrictTable& table) {
  constexpr const char* key = "bending_stiffness";
  const Range range = Range::positive();
  if (!table.is_array(key)) {
    const std::optional<double> both =
        table.optional_number(key, Dimension::section_stiffness, range);
    if (!both) return std::nullopt;
    return GivenBending{*both, std::nullopt};
  }
  const Eigen::Vector2d pair = table.optional_pair(key, Dimension::section_stiffness).value();
  if (!range.holds(pair.x()) || !range.holds(pair.y())) {
    table.fail(key, fmt::format("out of range (allowed: {}, about d1 and about d2)", range.text));
  }
  return GivenBending{pair.x(), pair.y()};
}

/// Reads EI of a rod that is given by its EI, or by the joints of a chain.
std::optional<GivenBending> read_bending(StrictTable& rod, double length) {
  const std::optional<double> joint =
      rod.optional_number("joint_stiffness", Dimension::joint_stiffness, Range::positive());
  const std::optional<double> spacing = rod.optional_number(
      "joint_spacing", Dimension::length, Range::between(1e-6 * length, length, " m"));
  if (!joint && !spacing) return read_bending_stiffness(rod);
  if (!joint || !spacing) {
    rod.fail(joint ? "joint_spacing" : "joint_stiffness",
             "missing, joint_stiffness and joint_spacing are given together (allowed: both; EI is "
             "one times the other)");
  }
  if (rod.has("bending_stiffness")) {
    rod.fail("bending_stiffness",
             "EI is given twice, by the joints of a chain too (allowed: bending_stiffness, or "
             "joint_stiffness and joint_spacing)");
  }
  return GivenBending{*joint * *spacing, std::nullopt};
}

constexpr const char* section_keys[] = {"diameter", "inner_diameter", "width", "thickness"};

/// Reads a circle, a ring, or a rectangle.
void read_cross_section(StrictTable& rod, Scene& scene) {
  const Range size = Range::between(1e-9, 1e3, " m");
  if (!rod.has("width") && !rod.has("thickness")) {
    scene.diameter = rod.number("diameter", Dimension::length, size);
    const Range bore{0, std::nextafter(scene.diameter, 0), false,
                     fmt::format("0 to less than diameter, {:g} m", scene.diameter)};
    const std::optional<double> inner =
        rod.optional_number("inner_diameter", Dimension::length, bore);
    if (!inner) return;
    scene.inner_diameter = *inner;
    return;
  }
  for (const char* key : {"diameter", "inner_diameter"}) {
    if (!rod.has(key)) continue;
    rod.fail(key, fmt::format("given besides {} (allowed: diameter, with inner_diameter of a tube; "
                              "or width along d1 and thickness along d2)",
                              rod.has("width") ? "width" : "thickness"));
  }
  for (const char* key : {"width", "thickness"}) {
    if (rod.has(key)) continue;
    rod.fail(key,
             "missing, width along d1 and thickness along d2 are given together (allowed: "
             "both, or a diameter)");
  }
  scene.width = rod.number("width", Dimension::length, size);
  scene.thickness = rod.number("thickness", Dimension::length, size);
}

/// Reads bending stiffness and mass: given values, or material and section.
void read_stiffness(StrictTable& rod, const std::vector<Material>& known_materials, Scene& scene) {
  if (const std::optional<GivenBending> given = read_bending(rod, scene.length)) {
    scene.given_bending_stiffness = given->about_d1;
    scene.given_bending_stiffness_2 = given->about_d2;
  }
  scene.given_mass_per_length =
      rod.optional_number("mass_per_length", Dimension::mass_per_length, Range::not_negative());
  const bool has_bending = scene.given_bending_stiffness.has_value();
  const bool has_mass = scene.given_mass_per_length.has_value();
  const bool has_material = rod.has("material");
  if (!has_material && has_bending != has_mass) {
    const char* bending = rod.has("joint_stiffness") ? "joint_stiffness" : "bending_stiffness";
    rod.fail(has_bending ? "mass_per_length" : "bending_stiffness",
             fmt::format("missing, it is required beside {} (allowed: both, or material and "
                         "diameter too)",
                         has_bending ? bending : "mass_per_length"));
  }
  const bool complete = has_bending && has_mass && !has_material;
  const bool has_section = std::any_of(std::begin(section_keys), std::end(section_keys),
                                       [&](const char* key) { return rod.has(key); });
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

/// Checks that stiffnesses derived from numbers in range are positive and finite.
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
  table.only(scene_keys("section"));
  section.from = read_arc_length(table, "from", scene.length);
  section.to = read_arc_length(table, "to", scene.length);
  if (!(section.to > section.from)) {
    table.fail("to", fmt::format("not behind from = {:g} m (allowed: more, up to {:g} m)",
                                 section.from, scene.length));
  }
  constexpr const char* own[] = {"bending_stiffness", "mass_per_length", "torsional_stiffness",
                                 "natural_curvature", "natural_twist"};
  if (std::none_of(std::begin(own), std::end(own),
                   [&](const char* key) { return table.has(key); })) {
    table.fail("bending_stiffness",
               "missing, and so are mass_per_length, torsional_stiffness, natural_curvature and "
               "natural_twist (allowed: one of the five or more; the others are the rod's own)");
  }
  const GivenBending bending = read_bending_stiffness(table).value_or(
      GivenBending{scene.bending_stiffness(), scene.bending_stiffness_2()});
  section.bending_stiffness = bending.about_d1;
  section.bending_stiffness_2 = bending.about_d2;
  section.mass_per_length =
      table.optional_number("mass_per_length", Dimension::mass_per_length, Range::not_negative())
          .value_or(scene.mass_per_length());
  section.torsional_stiffness =
      table.optional_number("torsional_stiffness", Dimension::section_stiffness, Range::positive());
  if (section.torsional_stiffness && !scene.torsional_stiffness) {
    table.fail("torsional_stiffness",
               "the rod has none (allowed: rod.torsional_stiffness too, or none here)");
  }
  section.natural_curvature = table.optional_pair("natural_curvature", Dimension::curvature);
  section.natural_twist = table.optional_number("natural_twist", Dimension::twist, Range::any());
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
  std::stable_sort(along.begin(), along.end(), [&](std::size_t a, std::size_t b) {
    return sections[a].from < sections[b].from;
  });
  for (const std::size_t i : along) {
    if (!scene.sections.empty()) {
      const double before = scene.sections.back().to;
      if (std::abs(sections[i].from - before) <= same_place_share * scene.length) {
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
  if (rod.is_text("stretch") && rod.text("stretch") == "auto") {
    scene.stretch = Stretch::automatic;
  } else if (rod.has("stretch") && !rod.is_flag("stretch")) {
    rod.fail("stretch", "unknown (allowed: true, false or \"auto\")");
  } else if (rod.flag("stretch")) {
    scene.stretch = Stretch::counted;
  }
  if (scene.stretch != Stretch::none && !scene.known_axial_stiffness()) {
    rod.fail("stretch",
             "EA is not known (allowed: axial_stiffness, or material and section, or false)");
  }
}

}  // namespace

void read_rod(StrictTable& rod, std::vector<StrictTable>& sections,
              const std::vector<Material>& known_materials, Scene& scene) {
  rod.only(scene_keys("rod"));
  scene.length = rod.number("length", Dimension::length, Range::between(1e-6, 1e6, " m"));
  if (!read_layers(rod, known_materials, scene)) read_stiffness(rod, known_materials, scene);
  if (const std::optional<double> axial =
          rod.optional_number("axial_stiffness", Dimension::force, Range::positive())) {
    scene.given_axial_stiffness = axial;
  }
  read_stretch(rod, scene);
  const std::optional<double> torsional =
      rod.optional_number("torsional_stiffness", Dimension::section_stiffness, Range::positive());
  if (torsional) scene.torsional_stiffness = torsional;
  read_natural_strains(rod, scene);
  read_sections(sections, scene);
  read_rest_shape(rod, sections, scene);
  require_finite_rod(scene, rod);
  rod.finish();
}

}  // namespace dlo::compare
