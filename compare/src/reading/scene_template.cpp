#include "reading/scene_template.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "reading/read_scene.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

/// Calls `place` with a field's value in the type that its text shows: integer, number, array, or
/// else text. There are no booleans: true is a text.
template <typename Place>
void pass_value(const SceneField& field, const std::string& file, const Place& place) {
  const std::string& text = field.value.text();
  if (const auto integer = as_number<std::int64_t>(text)) return place(*integer);
  if (const auto number = as_number<double>(text)) return place(*number);
  if (text.empty() || text.front() != '[') return place(text);
  const toml::table parsed =
      parse_toml("value = " + text, fmt::format("{}, {}", file, field.field));
  const toml::array* array = parsed["value"].as_array();
  if (array == nullptr || parsed.size() != 1) {
    throw InputError(fmt::format("{}: {} = {}: no vector", file, field.field, text));
  }
  place(*array);
}

/// Returns the path of a key or symbol (E, EI) that is given without its table, or in [rod]
/// although it is in another one; empty for other fields.
std::string meant_by(const std::string& field) {
  const std::string given = field.starts_with("rod.") ? field.substr(4) : field;
  const std::string key = given == "E"    ? "youngs_modulus"
                          : given == "EI" ? "bending_stiffness"
                                          : given;
  for (const char* table : {"rod", "rod.material", "force_model"}) {
    if (!std::ranges::binary_search(scene_table(table).names, key)) continue;
    const std::string path = fmt::format("{}.{}", table, key);
    return path == field ? "" : path;
  }
  return {};
}

class Overrider {
 public:
  Overrider(toml::table& root, const std::string& file, const std::vector<Material>& materials,
            MissingElements missing)
      : root_(root), file_(file), materials_(materials), missing_(missing) {}

  void set(const SceneField& field) const {
    if (const std::string meant = meant_by(field.field); !meant.empty()) {
      refuse(field.field, fmt::format("did you mean {}?", meant));
    }
    if (std::count(field.field.begin(), field.field.end(), '.') >= deepest_nesting) {
      refuse(field.field.substr(0, 40) + "...",
             fmt::format("too many dotted parts (allowed: {})", deepest_nesting));
    }
    toml::node* parent = &root_;
    std::string_view rest = field.field;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      const std::string_view step = rest.substr(0, dot);
      rest.remove_prefix(dot + 1);
      if (missing_ == MissingElements::made) make(*parent, step, rest);
      parent = &enter(*parent, step, field.field);
    }
    if (rest.empty()) refuse(field.field, "a part of the path is empty");
    if (toml::table* table = parent->as_table()) {
      pass_value(field, file_, [&](const auto& value) { table->insert_or_assign(rest, value); });
      return;
    }
    toml::array& array = *parent->as_array();
    const std::size_t index = element(array, rest, field.field);
    pass_value(field, file_, [&](const auto& value) {
      array.insert(array.erase(array.cbegin() + static_cast<std::ptrdiff_t>(index)), value);
    });
  }

 private:
  [[noreturn]] void refuse(const std::string& path, const std::string& problem) const {
    throw InputError(fmt::format("{}: {}: {}", file_, path, problem));
  }

  [[nodiscard]] std::size_t element(const toml::array& array, std::string_view step,
                                    const std::string& path) const {
    const auto index = as_number<std::size_t>(step);
    if (!index || *index >= array.size()) {
      refuse(path, array.empty() ? fmt::format("there is no \"{}\", the array is empty", step)
                                 : fmt::format("there is no \"{}\" (allowed: 0 to {})", step,
                                               array.size() - 1));
    }
    return *index;
  }

  /// Appends a table to an array if `step` is its next index, or inserts an array if a number
  /// follows in the path.
  static void make(toml::node& parent, std::string_view step, std::string_view rest) {
    toml::array* array = parent.as_array();
    if (array != nullptr && as_number<std::size_t>(step) == array->size()) {
      array->push_back(toml::table());
    } else if (array == nullptr && as_number<std::size_t>(rest.substr(0, rest.find('.')))) {
      parent.as_table()->insert(step, toml::array());
    }
  }

  /// Returns the table or array `step` of `parent`. A missing table is added empty; a rod's
  /// material that is given by its name is replaced by the table of its values.
  toml::node& enter(toml::node& parent, std::string_view step, const std::string& path) const {
    toml::node* child = nullptr;
    if (toml::table* table = parent.as_table()) {
      if (step.empty()) refuse(path, "a part of the path is empty");
      if (!table->contains(step)) table->insert(step, toml::table());
      if (&parent == root_.get("rod") && step == "material") expand_material(*table);
      child = table->get(step);
    } else {
      toml::array& array = *parent.as_array();
      child = array.get(element(array, step, path));
    }
    if (!child->is_table() && !child->is_array()) {
      refuse(path, fmt::format("\"{}\" is a single value and has no parts", step));
    }
    return *child;
  }

  void expand_material(toml::table& rod) const {
    const auto name = rod["material"].value_exact<std::string>();
    if (!name) return;
    for (const Material& material : materials_) {
      if (material.name != *name) continue;
      rod.insert_or_assign("material", toml::table{{"youngs_modulus", material.youngs_modulus},
                                                   {"density", material.density}});
      return;
    }
    refuse("rod.material", fmt::format("unknown material \"{}\"", *name));
  }

  toml::table& root_;
  const std::string& file_;
  const std::vector<Material>& materials_;
  MissingElements missing_;
};

/// Returns the names of files in a scene.
std::vector<std::string*> file_names(toml::table& root) {
  std::vector<std::string*> names;
  const auto add = [&names](toml::node& node, const std::string& key) {
    toml::table* const table = node.as_table();
    toml::value<std::string>* const file = table ? (*table)[key].as_string() : nullptr;
    if (file != nullptr) names.push_back(&file->get());
  };
  for (const SceneTable& rows : scene_tables()) {
    toml::node* const node = root.get(rows.name);
    for (const SceneKey& key : rows.keys) {
      if (node == nullptr || !key.value.starts_with("file")) continue;
      if (toml::array* const tables = node->as_array()) {
        for (toml::node& table : *tables) add(table, key.name);
      } else {
        add(*node, key.name);
      }
    }
  }
  return names;
}

/// Returns the gravity with which the scene has this gamma.
toml::array scaled_gravity(const Scene& scene, const std::string& gamma) {
  const auto value = as_number<double>(gamma);
  if (!value || !(*value >= 0) || !std::isfinite(*value)) {
    throw InputError(
        fmt::format("{}: gamma = {}: must be a number (allowed: >= 0)", scene.file, gamma));
  }
  if (!(scene.gamma() > 0)) {
    throw InputError(fmt::format(
        "{}: gamma = {}: gravity or density is zero and cannot be scaled (allowed: > 0)",
        scene.file, gamma));
  }
  const Eigen::Vector3d gravity = *value / scene.gamma() * scene.gravity;
  return toml::array(gravity.x(), gravity.y(), gravity.z());
}

}  // namespace

struct SceneTemplate::Parsed {
  SceneSource source;
  std::vector<Material> materials;
  MissingElements missing;
  std::filesystem::path folder;  // folder of the files that fields name; empty if the source has it
  // EI, or the mean to which GJ is proportional, with the values of the file. Empty if GJ is not
  // given, or if the file is not a valid scene without other values.
  std::optional<double> bending_stiffness;
};

SceneTemplate::SceneTemplate(const std::string& text, const std::string& name,
                             std::vector<Material> known_materials, MissingElements missing,
                             const std::string& folder) {
  const auto parsed = std::make_shared<Parsed>(Parsed{
      parse_scene_source(text, name), std::move(known_materials), missing, folder, std::nullopt});
  parsed_ = parsed;
  if (!parsed->source.root["rod"]["torsional_stiffness"]) return;
  try {
    parsed->bending_stiffness = with({}).mean_bending_stiffness();
  } catch (const InputError&) {  // The scene is valid only with other values.
    return;
  }
}

Scene SceneTemplate::with(const std::vector<SceneField>& values) const {
  SceneSource source = parsed_->source;
  toml::table& root = source.root;
  const Overrider overrider(root, source.where, parsed_->materials, parsed_->missing);
  const SceneField* gamma = nullptr;
  for (const SceneField& value : values) {
    if (value.field == "gamma") {
      gamma = &value;
    } else {
      overrider.set(value);
    }
  }
  for (std::string* const file : file_names(root)) *file = (parsed_->folder / *file).string();
  Scene scene = read_scene(source, parsed_->materials);
  if (gamma != nullptr) {
    root.insert_or_assign("gravity", scaled_gravity(scene, gamma->value.text()));
    scene = read_scene(source, parsed_->materials);
  }
  const bool gives_torsion = std::ranges::any_of(
      values, [](const SceneField& value) { return value.field == "rod.torsional_stiffness"; });
  if (scene.torsional_stiffness && parsed_->bending_stiffness && !gives_torsion) {
    // The ratio is computed first, so that GJ is unchanged if EI is.
    *scene.torsional_stiffness *= scene.mean_bending_stiffness() / *parsed_->bending_stiffness;
  }
  return scene;
}

std::string SceneValue::number_text(double number) { return fmt::format("{}", number); }

SceneValue::SceneValue(std::initializer_list<SceneValue> list) : text_("[") {
  for (const SceneValue& value : list) {
    const bool quoted =
        value.text_.empty() || (value.text_.front() != '[' && !as_number<double>(value.text_));
    text_ += (quoted ? toml_string(value.text_) : value.text_) + ", ";
  }
  text_ += "]";
}

Scene make_scene(const std::vector<SceneField>& fields, const std::string& file) {
  return SceneTemplate("", file, materials(), MissingElements::made).with(fields);
}

SceneTemplate load_scene_template(const std::string& path,
                                  const std::vector<Material>& known_materials) {
  const std::filesystem::path file(path);
  return {read_file(path), file.filename(), known_materials, MissingElements::refused,
          file.parent_path()};
}

}  // namespace dlo::compare
