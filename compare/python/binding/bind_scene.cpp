#include "bind_scene.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <functional>
#include <limits>
#include <sstream>

#include "array.hpp"
#include "base/input_file.hpp"
#include "base/text.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material.hpp"
#include "document.hpp"
#include "format/scene_document.hpp"
#include "module.hpp"
#include "reading/read_scene.hpp"
#include "result.hpp"
#include "toml/quantity.hpp"
#include "toml/strict_table.hpp"

namespace dlo::python {
namespace {

using namespace py::literals;  // NOLINT(google-build-using-namespace): of names alone

SharedScene scene_from(const compare::SceneSource& source, const MaterialsFile& materials) {
  SceneData data{compare::read_scene(source, materials_of(materials)), {}};
  const toml::table& root = source.root;
  if (const toml::array* obstacles = root["obstacle"].as_array()) {
    for (const toml::node& obstacle : *obstacles) {
      const bool axis = obstacle.as_table()->at_path("touches").value_or("") == std::string("axis");
      data.obstacle_offsets.push_back(axis ? 0 : data.scene.diameter / 2);
    }
  }
  return std::make_shared<SceneData>(std::move(data));
}

py::tuple parse_scene(const std::string& text, const std::string& file,
                      const MaterialsFile& materials) {
  const compare::SceneSource source = compare::parse_scene_source(text, file);
  SharedScene scene = scene_from(source, materials);
  return py::make_tuple(std::move(scene), to_python(source.root));
}

std::string toml_text(const py::dict& document) {
  std::ostringstream text;
  text << to_toml(document, "") << "\n";
  return text.str();
}

SharedScene scene_at(const SharedScene& data, double time) {
  if (!compare::motion_time_span(data->scene)) {
    throw compare::InputError(
        fmt::format("{}: time = {:g}: nothing moves (allowed: None, or a scene with "
                    "[[gripper.pose]] or [[obstacle.pose]])",
                    data->scene.file, time));
  }
  return std::make_shared<SceneData>(
      SceneData{compare::scene_at(data->scene, time), data->obstacle_offsets, data->calibrated});
}

SharedScene calibrated_scene(const SharedScene& data, const std::string& text,
                             const std::string& file) {
  compare::CalibratedRod rod = compare::parse_calibrated_rod(text, file);
  compare::Scene scene = compare::calibrated_scene(data->scene, rod);
  return std::make_shared<SceneData>(
      SceneData{std::move(scene), data->obstacle_offsets, std::move(rod)});
}

/// Returns the rows of scene_tables() by table and key: form and dimension, SI unit, allowed
/// values, default, words.
py::dict table_keys() {
  py::dict tables;
  for (const compare::SceneTable& table : compare::scene_tables()) {
    py::dict keys;
    for (const compare::SceneKey& key : table.keys) {
      const std::vector<std::string> units = compare::unit_names(key.dimension);
      const std::string inner = (table.name.empty() ? "" : table.name + ".") + key.name;
      keys[py::str(key.name)] =
          py::make_tuple(key.value, units.empty() ? "" : units.front(), key.range.text, key.missing,
                         key.words.empty() ? compare::scene_table(inner).words : key.words);
    }
    tables[py::str(table.name)] = keys;
  }
  return tables;
}

py::list material_list(const MaterialsFile& file) {
  py::list list;
  for (const compare::Material& material : materials_of(file)) {
    list.append(py::dict("name"_a = material.name, "youngs_modulus"_a = material.youngs_modulus,
                         "density"_a = material.density, "source"_a = material.source));
  }
  return list;
}

}  // namespace

compare::MeasuredShape measured_shape(const py::object& points, const py::object& arc_length,
                                      const std::string& name) {
  if (py::isinstance<py::bytes>(points)) {
    if (!arc_length.is_none()) {
      throw compare::InputError(
          "arc_length: given besides the name of a file (allowed: the file's own column s)");
    }
    const auto path = points.cast<std::string>();
    return compare::parse_shape(compare::read_file(compare::file_of_shape(path)),
                                compare::valid_utf8(path));
  }
  return compare::shape_of(
      points_from(points, name),
      arc_length.is_none() ? std::vector<double>{} : values_from(arc_length, "arc_length"), name);
}

std::vector<compare::Material> materials_of(const MaterialsFile& file) {
  return file ? compare::read_materials(file->first, file->second) : compare::materials();
}

std::vector<compare::Scene> scenes_of(const std::vector<SharedScene>& shared) {
  std::vector<compare::Scene> scenes;
  scenes.reserve(shared.size());
  for (const SharedScene& scene : shared) scenes.push_back(scene->scene);
  return scenes;
}

void bind_scene(py::module_& module) {
  using compare::Scene;
  py::class_<SceneData, std::shared_ptr<SceneData>> bound(
      module, "SceneData", "A scene as the reader has it, in SI units.");
  refuse_pickle(bound, "pickled or copied", "the dlo.Scene");
  refuse_new(bound, "dlo.Scene");
  const auto add = [&bound](const char* name, auto get, const char* words = "") {
    bound.def_property_readonly(
        name, [get](const SceneData& data) { return std::invoke(get, data.scene); }, words);
  };
  // Values of keys as the reader has them; Python has the words of their rows.
  add("name", [](const Scene& s) { return s.name; });
  add("gravity", [](const Scene& s) { return vector_copy(s.gravity); });
  add("length", [](const Scene& s) { return s.length; });
  add("diameter", [](const Scene& s) { return s.diameter; });
  add("inner_diameter", [](const Scene& s) { return s.inner_diameter; });
  add("width", [](const Scene& s) { return s.width; });
  add("thickness", [](const Scene& s) { return s.thickness; });
  add("bending_stiffness", [](const Scene& s) { return s.bending_stiffness(); });
  add("axial_stiffness", [](const Scene& s) { return s.axial_stiffness(); });
  add("mass_per_length", [](const Scene& s) { return s.mass_per_length(); });
  // Derived values.
  add(
      "youngs_modulus", [](const Scene& s) { return s.material.youngs_modulus; },
      "E of the material [Pa]; 0: not known.");
  add(
      "density", [](const Scene& s) { return s.material.density; },
      "Density of the material [kg/m^3]; 0: not known.");
  add("mass", &Scene::mass, "Mass of the rod, with sections [kg].");
  add("gamma", &Scene::gamma, "w l^3 / (EI) [-]: below 0.1 nearly straight, from 1000 on a rope.");
  add("planar", &Scene::planar,
      "Whether the rod stays in a plane that contains grips, forces and obstacles in reach.");
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  add(
      "rest_shape_error",
      [](const Scene& s) { return s.rest_shape ? s.rest_shape->largest_error : none; },
      "Largest distance of rest_shape's points from the arcs [m]; NaN without.");
  add(
      "rest_shape_angle",
      [](const Scene& s) {
        return s.rest_shape ? s.rest_shape->largest_angle.value_or(none) : none;
      },
      "Largest angle of a given d1 from that of the arcs [rad]; NaN without.");
  module.attr("scene_keys") = table_keys();
  module.def("did_you_mean", &compare::did_you_mean);
  module.def("read_scene",
             [](const py::dict& document, const std::string& file, const MaterialsFile& materials) {
               return scene_from({to_toml(document, ""), file, file, std::nullopt}, materials);
             });
  module.def("parse_scene", &parse_scene);
  module.def("scene_document", [](const SharedScene& scene, std::optional<int> points) {
    compare::Scene exported = scene->scene;
    if (points) exported.force_model.points = *points;
    return compare::scene_document_text(exported);
  });
  module.def("scene_at", &scene_at);
  module.def("calibrated_scene", &calibrated_scene);
  module.def("read_file", &compare::read_file);
  module.def("toml_text", &toml_text);
  // The value of a text with a unit, in SI units. A form of several numbers has no dimension.
  module.def("quantity", [](const std::string& text, const std::string& dimension) {
    const auto named = compare::dimension_named(dimension);
    return compare::parse_quantity(text, named.value_or(compare::Dimension::number));
  });
  module.def("materials", &material_list);
}

}  // namespace dlo::python
