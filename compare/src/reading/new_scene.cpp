#include "reading/new_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/quote.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "scene/builtin_data.hpp"
#include "toml/quantity.hpp"

namespace dlo::compare {
namespace {

/// Returns numbers and vectors as they are, everything else as a TOML string.
std::string toml_value(const std::string& value) {
  if (value.starts_with('[')) return value;
  try {
    // TOML allows neither ".5" nor "5.".
    return fmt::format("{}", parse_quantity(value, Dimension::number));
  } catch (const InputError&) {
    return toml_string(value);
  }
}

bool is_z_up(const SceneChoices& choices) { return choices.up == "z"; }

/// Returns an upward vector of this length; a downward one if the length is negative.
std::string upwards(const SceneChoices& choices, double length) {
  const std::string text = fmt::format("{:.4g}", length);
  return is_z_up(choices) ? "[0, 0, " + text + "]" : "[0, " + text + ", 0]";
}

/// Returns the direction as a vector if z is up, because angles in a scene file are in the x-y
/// plane, which is then horizontal.
std::string direction_value(const SceneChoices& choices) {
  if (!is_z_up(choices) || choices.direction.starts_with('[')) {
    return toml_value(choices.direction);
  }
  try {
    const double angle = parse_quantity(choices.direction, Dimension::angle);
    const auto rounded = [](double value) { return std::abs(value) < 1e-15 ? 0 : value; };
    return fmt::format("[{}, 0, {}]", rounded(std::cos(angle)), rounded(std::sin(angle)));
  } catch (const InputError&) {
    return toml_value(choices.direction);  // errors are reported when the scene is read
  }
}

std::string direction_words(const SceneChoices& choices) {
  return is_z_up(choices)
             ? "# Of the rod there, along growing arc length: a vector; [0, 0, -1] hangs down, [1, "
               "0, 0] is\n# level. A pin has none."
             : "# Of the rod there, along growing arc length: an angle in the x-y plane from +x "
               "(\"-90 deg\" hangs\n# down; without unit: rad), or a vector such as [1, 0, 0]. A "
               "pin has none.";
}

std::string material_lines(const SceneChoices& choices, const std::vector<Material>& known) {
  std::string names;
  for (const Material& material : known) {
    names += (names.empty() ? "" : (names.size() - names.rfind('\n')) > 75 ? ",\n#   " : ", ");
    names += material.name;
  }
  const std::string head = fmt::format(
      "# A name, or your own as {{ youngs_modulus = \"5 MPa\", density = \"1100 kg/m^3\" }}.\n"
      "# Moduli in Pa, kPa, MPa, GPa; densities in kg/m^3, g/cm^3. dlo materials lists the "
      "values:\n"
      "#   {}\n",
      names);
  if (choices.youngs_modulus.empty()) {
    return head + fmt::format("material = {}\n", toml_string(choices.material));
  }
  return head + fmt::format("material = {{ youngs_modulus = {}, density = {} }}\n",
                            toml_value(choices.youngs_modulus), toml_value(choices.density));
}

std::string required_part(const SceneChoices& choices, const std::vector<Material>& known) {
  return fmt::format(fmt::runtime(builtin::new_scene_toml),
                     fmt::arg("name", toml_string(choices.name)),
                     fmt::arg("units", known_units(Dimension::length)),
                     fmt::arg("length", toml_value(choices.length)),
                     fmt::arg("diameter", toml_value(choices.diameter)),
                     fmt::arg("material", material_lines(choices, known)),
                     fmt::arg("gravity", upwards(choices, -9.81)), fmt::arg("up", choices.up),
                     fmt::arg("direction_words", direction_words(choices)),
                     fmt::arg("direction", direction_value(choices)));
}

enum class Meaning { said, omitted };

/// Returns the names as in TOML, with their meanings if `meaning` requests it.
template <Chosen Value>
std::string toml_choices(Meaning meaning) {
  std::vector<std::string> choices;
  for (const auto& choice : Choices<Value>::all) {
    choices.push_back(toml_string(choice.name));
    if (meaning == Meaning::said) choices.back() += fmt::format(" ({})", choice.meaning);
  }
  return one_of(choices);
}

/// Returns examples that fit the rod: a pin at its end, a small force, a floor in its reach.
std::string optional_part(const SceneChoices& choices, const Scene& scene) {
  const double l = scene.length;
  const Eigen::Vector3d pin = 0.7 * l * scene.grippers.front().direction.value();
  const double weight = scene.mass() * scene.gravity.norm();
  const ForceModelSettings defaults;
  const double force = weight > 0 ? weight : scene.bending_stiffness() / (l * l);
  return fmt::format(
      fmt::runtime(builtin::new_scene_optional_toml),
      fmt::arg("torsion", scene.bending_stiffness() / 1.3), fmt::arg("length", l),
      fmt::arg("section_from", 0.4 * l), fmt::arg("section_to", 0.45 * l),
      fmt::arg("section_EI", 10 * scene.bending_stiffness()),
      fmt::arg("section_mass", 2 * scene.mass_per_length()), fmt::arg("x", pin.x()),
      fmt::arg("y", pin.y()), fmt::arg("z", pin.z()), fmt::arg("middle", l / 2),
      fmt::arg("force", upwards(choices, -0.1 * force)),
      fmt::arg("floor",
               upwards(choices, std::min(is_z_up(choices) ? pin.z() : pin.y(), 0.0) - 0.1 * l)),
      fmt::arg("normal", upwards(choices, 1)), fmt::arg("stiffness", 1e3 * force / (l * l)),
      fmt::arg("c_c", scene.axial_stiffness()), fmt::arg("direction", direction_value(choices)),
      fmt::arg("frames", scene.track.frames), fmt::arg("steps", scene.track.steps),
      fmt::arg("points", defaults.points), fmt::arg("law", to_string(defaults.law)),
      fmt::arg("laws", toml_choices<BendingLaw>(Meaning::said)),
      fmt::arg("joint_laws", toml_choices<energy_model::JointLaw>(Meaning::omitted)),
      fmt::arg("bookkeeping", to_string(defaults.bookkeeping)),
      fmt::arg("bookkeepings", toml_choices<Bookkeeping>(Meaning::said)),
      fmt::arg("stepper", to_string(defaults.stepper)),
      fmt::arg("steppers", toml_choices<Stepper>(Meaning::omitted)),
      fmt::arg("bending_rules", toml_choices<BendingRule>(Meaning::omitted)));
}

}  // namespace

std::string scene_text(const SceneChoices& choices, const std::vector<Material>& known_materials) {
  const std::string text = required_part(choices, known_materials);
  const Scene scene = parse_scene(text, "the new scene", known_materials);
  if (scene.diameter > scene.length) {
    throw InputError("the new scene", "rod.diameter",
                     fmt::format(" = {}: thicker than long (allowed: at most the length, {:g} m)",
                                 choices.diameter, scene.length));
  }
  return text + optional_part(choices, scene);
}

}  // namespace dlo::compare
