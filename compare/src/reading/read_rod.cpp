#include "scene/read_rod.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "base/words.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/rest_shape.hpp"
#include "dlo/compare/shape_file.hpp"
#include "toml/scene_keys.hpp"
#include "trajectory/read_trajectory.hpp"

namespace dlo::compare {
namespace {

/// Beyond it no solver resolves the layer at a clamp, and no rod looks any different.
constexpr double largest_gamma = 1e12;
/// Of Legendre's polynomials; beyond it a curvature has more waves than a smooth rod.
constexpr std::size_t most_natural_terms = 24;
/// Arc lengths of two sections that meet may differ by what rounding of units makes [-].
constexpr double same_place_share = 1e-12;

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

/// EI about every axis across the rod, or about d1 and d2.
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

/// EI of a chain's rod, or of one that is given by its own.
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

/// A circle, a ring, or a rectangle.
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

/// A cable's section, mass and stiffness. @return whether the rod has layers
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

/// Bending stiffness and mass, given as they are or by material and section.
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
    rod.fail("diameter",
             "missing, the material says nothing without it (allowed: a diameter, or no material)");
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

/// Of numbers that are in range each on its own.
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
  // The negation makes a NaN out of range.
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

/// That the stress-free shape is said in one way.
void require_one_rest_shape(const StrictTable& rod) {
  for (const char* key : {"helix", "rest_shape"}) {
    for (const char* other : {"natural_curvature", "natural_twist", "helix"}) {
      if (!rod.has(key) || !rod.has(other) || std::string_view(key) == other) continue;
      rod.fail(key, fmt::format("given besides {} (allowed: natural_curvature with natural_twist, "
                                "or helix, or rest_shape)",
                                other));
    }
  }
}

void read_natural_strains(StrictTable& rod, Scene& scene) {
  require_one_rest_shape(rod);
  const std::vector<Eigen::Vector2d> curvature =
      rod.pairs("natural_curvature", Dimension::curvature, most_natural_terms);
  if (!curvature.empty()) {
    scene.natural_strain.head<2>() = curvature.front();
    scene.natural_variation.assign(curvature.begin() + 1, curvature.end());
  }
  scene.natural_strain.z() =
      rod.optional_number("natural_twist", Dimension::twist, Range::any()).value_or(0);
  if (std::optional<StrictTable> helix = rod.optional_table("helix")) {
    helix->only(scene_keys("helix"));
    const Range size = Range::between(1e-9, 1e6, " m");
    const Range rise = Range::between(-1e6, 1e6, " m, > 0 right-handed, < 0 left-handed");
    const double radius = helix->number("radius", Dimension::length, size);
    const double pitch = helix->number("pitch", Dimension::length, rise);
    helix->finish();
    scene.natural_strain = helix_strain(radius, pitch);
  }
}

/// A file's points, or rows of three.
MeasuredShape read_rest_points(StrictTable& rod, const std::string& scene_file) {
  constexpr const char* key = "rest_shape";
  constexpr const char* allowed =
      "(allowed: a file of points in m beside the scene, as CSV with the columns x,y,z and, with "
      "frames, d1_x,d1_y,d1_z, or rows [[x, y, z], ..])";
  if (!rod.is_array(key)) {
    const std::string name = rod.text(key);
    return parse_shape(read_beside(rod, key, file_of_shape(name), scene_file, allowed), name);
  }
  constexpr std::size_t most = 10'000;
  const Eigen::MatrixXd rows = rod.points(key, most);
  return shape_of(rows.topRows<3>(), {}, "the points",
                  rows.rows() == 6 ? Eigen::Matrix3Xd(rows.bottomRows<3>()) : Eigen::Matrix3Xd());
}

/// @param sections  the tables of the rod's sections, which have been read
void read_rest_shape(StrictTable& rod, const std::vector<StrictTable>& sections, Scene& scene) {
  if (!rod.has("rest_shape")) return;
  for (const StrictTable& section : sections) {
    for (const char* key : {"natural_curvature", "natural_twist"}) {
      if (!section.has(key)) continue;
      section.fail(key,
                   "given besides rod.rest_shape, which says it all along (allowed: one of "
                   "the two)");
    }
  }
  try {
    scene.set_rest_shape(fit_rest_shape(read_rest_points(rod, scene.file), scene.length));
  } catch (const InputError& error) {
    // One that the table has made says where it is already.
    if (!error.key().empty()) throw;
    rod.fail("rest_shape", error.what());
  }
}

/// @param scene  its EA has been read
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

double read_arc_length(StrictTable& table, std::string_view key, double length) {
  Range range = Range::between(0, length, " m, the rod's length");
  range.low -= arc_rounding * length;
  range.high += arc_rounding * length;
  return *on_rod(table.number(key, Dimension::length, range), length);
}

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
