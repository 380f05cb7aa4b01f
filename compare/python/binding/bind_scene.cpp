#include "bind_scene.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <limits>
#include <map>
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

/// Returns a quantity in SI units. @param unit  SI unit of its dimension; empty: a number
double quantity(const std::string& text, const std::string& unit) {
  using compare::Dimension;
  static const auto dimensions = [] {
    std::map<std::string, Dimension> of_units = {{"", Dimension::number}};
    for (int i = 1; i <= static_cast<int>(Dimension::frequency); ++i) {
      const auto dimension = static_cast<Dimension>(i);
      of_units[compare::unit_names(dimension).front()] = dimension;
    }
    return of_units;
  }();
  return compare::parse_quantity(text, dimensions.at(unit));
}

py::dict settings_of(const SceneData& data) {
  const compare::ForceModelSettings& settings = data.scene.force_model;
  py::dict result;
  result["points"] = settings.points;
  result["law"] = compare::to_string(settings.law);
  result["joint_law"] = settings.joint_law
                            ? py::object(py::str(compare::to_string(*settings.joint_law)))
                            : py::none();
  result["bookkeeping"] = compare::to_string(settings.bookkeeping);
  result["stepper"] = compare::to_string(settings.stepper);
  result["bending_rule"] = compare::to_string(settings.bending_rule);
  result["design_curvature"] = settings.design_curvature;
  result["point_weight"] = settings.point_weight;
  result["c_b"] = settings.c_b;
  result["c_c"] = settings.c_c;
  result["c_F"] = settings.c_F;
  result["c_h"] = settings.c_h;
  result["l_s"] = settings.l_s;
  return result;
}

py::dict rates_of(const SceneData& data) {
  const compare::TrackRates& rates = data.scene.track;
  std::optional<std::string> start;
  if (data.scene.start) start = data.scene.start->file;
  return py::dict("frame_rate"_a = rates.frames, "obstacle_rate"_a = rates.obstacles,
                  "step_rate"_a = rates.steps, "start"_a = start);
}

SharedScene scene_at(const SharedScene& data, double time) {
  if (!compare::motion_of(data->scene)) {
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

py::dict table_keys() {
  py::dict keys;
  for (const compare::SceneTable& table : compare::scene_tables()) {
    keys[py::str(table.name)] = py::cast(table.names);
  }
  return keys;
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
  const auto add = [&bound](const char* name, auto get) {
    bound.def_property_readonly(name, [get](const SceneData& data) { return get(data.scene); });
  };
  add("name", [](const Scene& s) { return s.name; });
  add("gravity", [](const Scene& s) { return vector_copy(s.gravity); });
  add("length", [](const Scene& s) { return s.length; });
  add("diameter", [](const Scene& s) { return s.diameter; });
  add("inner_diameter", [](const Scene& s) { return s.inner_diameter; });
  add("width", [](const Scene& s) { return s.width; });
  add("thickness", [](const Scene& s) { return s.thickness; });
  add("youngs_modulus", [](const Scene& s) { return s.material.youngs_modulus; });
  add("density", [](const Scene& s) { return s.material.density; });
  add("bending_stiffness", [](const Scene& s) { return s.bending_stiffness(); });
  add("axial_stiffness", [](const Scene& s) { return s.axial_stiffness(); });
  add("mass_per_length", [](const Scene& s) { return s.mass_per_length(); });
  add("mass", [](const Scene& s) { return s.mass(); });
  add("gamma", [](const Scene& s) { return s.gamma(); });
  add("planar", [](const Scene& s) { return s.planar(); });
  add("rest_shape_error", [](const Scene& s) {
    return s.rest_shape ? s.rest_shape->largest_error : std::numeric_limits<double>::quiet_NaN();
  });
  add("rest_shape_angle", [](const Scene& s) {
    return (s.rest_shape ? s.rest_shape->largest_angle : std::nullopt)
        .value_or(std::numeric_limits<double>::quiet_NaN());
  });
  bound.def_property_readonly("force_model", settings_of).def_property_readonly("track", rates_of);
  module.attr("scene_keys") = table_keys();
  module.def("did_you_mean", &compare::did_you_mean);
  module.def("read_scene",
             [](const py::dict& document, const std::string& file, const MaterialsFile& materials) {
               return scene_from({to_toml(document, ""), file, file, std::nullopt}, materials);
             });
  module.def("parse_scene", &parse_scene);
  module.def("scene_document", [](const SharedScene& scene, std::optional<int> points) {
    compare::Scene told = scene->scene;
    if (points) told.force_model.points = *points;
    return compare::scene_document_text(told);
  });
  module.def("scene_at", &scene_at);
  module.def("calibrated_scene", &calibrated_scene);
  module.def("read_file", &compare::read_file);
  module.def("toml_text", &toml_text);
  module.def("quantity", &quantity);
  module.def("materials", &material_list);
}

}  // namespace dlo::python
