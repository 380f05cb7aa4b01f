#include "reading/new_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "toml/scene_keys.hpp"

namespace dlo::compare {
namespace {

/// Returns a vector as it is, a number as TOML spells it, everything else as a TOML string.
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
std::string upward_vector(const SceneChoices& choices, double length) {
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

/// Values of the keys of a new scene as in a file, by table and key: "rod.length".
using Values = std::map<std::string, std::string>;

Values required_values(const SceneChoices& choices) {
  return {{".name", toml_string(choices.name)},
          {".gravity", upward_vector(choices, -9.81)},
          {"rod.length", toml_value(choices.length)},
          {"rod.diameter", toml_value(choices.diameter)},
          {"rod.material",
           choices.youngs_modulus.empty()
               ? toml_string(choices.material)
               : fmt::format("{{ youngs_modulus = {}, density = {} }}",
                             toml_value(choices.youngs_modulus), toml_value(choices.density))},
          {"gripper.at", "0"},
          {"gripper.position", "[0, 0, 0]"},
          {"gripper.hold", "\"clamp\""},
          {"gripper.direction", direction_value(choices)}};
}

/// Returns examples that fit the rod: a section, a small force, a floor in its reach. Settings have
/// their defaults.
Values optional_values(const SceneChoices& choices, const Scene& scene) {
  const double l = scene.length;
  const double lowest =
      l * std::min(0.0, (*scene.grippers.front().direction)[is_z_up(choices) ? 2 : 1]);
  const double floor = 0.7 * lowest - std::max(0.1 * l, scene.diameter);
  const double weight = scene.mass() * scene.gravity.norm();
  const double force = weight > 0 ? weight : scene.bending_stiffness() / (l * l);
  const auto number = [](double value) { return fmt::format("{:.4g}", value); };
  Values values{{"section.from", number(0.4 * l)},
                {"section.to", number(0.45 * l)},
                {"section.bending_stiffness", number(10 * scene.bending_stiffness())},
                {"section.mass_per_length", number(2 * scene.mass_per_length())},
                {"load.at", number(l / 2)},
                {"load.force", upward_vector(choices, -0.1 * force)},
                {"obstacle.point", upward_vector(choices, floor)},
                {"obstacle.normal", upward_vector(choices, 1)},
                {"obstacle.stiffness", number(1e3 * force / (l * l))},
                {"obstacle.friction", "0.3"},
                {"track.obstacle_rate", "\"25 Hz\""},
                {"force_model.c_c", number(scene.axial_stiffness())}};
  for (const char* path : {"obstacle.shape", "obstacle.touches", "track.frame_rate",
                           "track.step_rate", "force_model.points", "force_model.law",
                           "force_model.bookkeeping", "force_model.stepper"}) {
    const std::string_view name = path;
    const std::size_t dot = name.find('.');
    values[path] = toml_value(scene_table(name.substr(0, dot)).key(name.substr(dot + 1)).missing);
  }
  return values;
}

std::string comment(const std::string& text, std::size_t blanks = 1) {
  constexpr std::size_t width = 98;
  const std::string lines = wrap(text, blanks + 2, width);
  return "#" + std::string(blanks, ' ') + replace_placeholders(lines, {{"\n", "\n#"}}) + "\n";
}

/// Returns the words of a key, with its units, what is allowed, and its default.
std::string key_description(const SceneKey& key) {
  std::vector<std::string> notes;
  for (const std::string& note : {known_units(key.dimension), key.range.text}) {
    if (!note.empty()) notes.push_back(note);
  }
  notes.push_back((key.missing.starts_with("required") ? "" : "if missing: ") + key.missing);
  return fmt::format("{} ({})", key.words, fmt::join(notes, "; "));
}

/// Returns the lines of a table: a key with a value as a line of TOML after its words, another key
/// as a comment with its example. @param mark  before each line of TOML
std::string table_text(const SceneTable& table, const Values& values, const std::string& mark) {
  std::string keys;
  bool has_values = false;
  for (const SceneKey& key : table.keys) {
    if (key.words.empty()) continue;
    const auto value = values.find(table.name + "." + key.name);
    const bool given = value != values.end();
    keys +=
        given ? comment(key_description(key))
              : comment(fmt::format("{} = {}: {}", key.name, key.example, key_description(key)), 3);
    if (given) keys += fmt::format("{}{} = {}\n", mark, key.name, value->second);
    has_values = has_values || given;
  }
  if (table.name.empty()) return "\n" + keys;
  return "\n" + comment(table.words) + (has_values ? mark : "# ") + table.header + "\n" + keys;
}

}  // namespace

std::string scene_text(const SceneChoices& choices, const std::vector<Material>& known_materials) {
  constexpr std::string_view required[] = {"", "rod", "gripper"};
  Values values = required_values(choices);
  std::string file;
  for (const std::string_view name : required) file += table_text(scene_table(name), values, "");
  const Scene scene = parse_scene(file, "the new scene", known_materials);
  if (scene.diameter > scene.length) {
    throw InputError("the new scene", "rod.diameter",
                     fmt::format(" = {}: thicker than long (allowed: at most the length, {:g} m)",
                                 choices.diameter, scene.length));
  }
  values.merge(optional_values(choices, scene));
  std::string text =
      "# A scene of dlo: a rod, what holds it and what pulls at it. It solves as it is:\n"
      "#   dlo solve FILE\n"
      "# Numbers are in SI units; a string may have another unit: 0.006 or \"6 mm\".\n"
      "# Lines that begin with # and no blank are optional parts: remove the # to use them.\n";
  for (const SceneTable& table : scene_tables()) {
    const bool needed = std::ranges::find(required, table.name) != std::end(required);
    text += table_text(table, values, needed ? "" : "#");
  }
  const Eigen::Vector3d pin = 0.7 * scene.length * *scene.grippers.front().direction;
  return text +
         fmt::format(
             "\n# A second gripper, here a pin at the other end.\n#[[gripper]]\n#at = {:.4g}\n"
             "#position = [{:.4g}, {:.4g}, {:.4g}]\n#hold = \"pin\"\n",
             scene.length, pin.x(), pin.y(), pin.z());
}

}  // namespace dlo::compare
