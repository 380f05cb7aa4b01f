
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "command/commands.hpp"
#include "format/json.hpp"
#include "format/scene_document.hpp"
#include "option/output.hpp"
#include "option/scene_options.hpp"

namespace dlo::cli {
namespace {

/// Units as suffixes of keys, longer suffixes first, and as text.
using KeyUnit = std::pair<std::string_view, std::string_view>;
constexpr KeyUnit key_units[] = {{"_kg_per_m3", "kg/m^3"},
                                 {"_kg_per_m2", "kg/m^2"},
                                 {"_N_per_m2", "N/m^2"},
                                 {"_rad_per_m", "rad/m"},
                                 {"_kg_per_m", "kg/m"},
                                 {"_N_per_m", "N/m"},
                                 {"_m_per_s", "m/s"},
                                 {"_per_m", "1/m"},
                                 {"_Nm2", "N m^2"},
                                 {"_rad", "rad"},
                                 {"_Nm", "N m"},
                                 {"_Pa", "Pa"},
                                 {"_kg", "kg"},
                                 {"_N", "N"},
                                 {"_m", "m"}};

/// Returns a value as text: numbers with six digits, lists in brackets, strings unchanged.
std::string json_value_text(const Json& value) {
  if (value.is_string()) return compare::display(value.get<std::string>());
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string out;
  for (const Json& entry : value) out += (out.empty() ? "" : ", ") + json_value_text(entry);
  return "[" + out + "]";
}

/// Returns "NAME VALUE UNIT", or an empty string if the table does not have the quantity, or if it
/// is zero or an empty list.
/// @param quantity  a key, whose suffix is the unit; or "name=key"; or "name=key:unit"
std::string quantity_text(const Json& table, const std::string& quantity) {
  const std::size_t equals = quantity.find('=');
  const std::size_t colon = quantity.find(':');
  const std::size_t begin = equals == std::string::npos ? 0 : equals + 1;
  const std::string key = quantity.substr(begin, colon - begin);
  if (!table.contains(key)) return "";
  const Json& value = table.at(key);
  const bool nothing = value.is_null() || value == 0.0 || (value.is_array() && value.empty());
  if (nothing) return "";
  std::string name = equals == std::string::npos ? key : quantity.substr(0, equals);
  std::string_view unit = colon == std::string::npos ? "" : quantity.c_str() + colon + 1;
  for (const auto& [end, words] : key_units) {
    if (!key.ends_with(end) || !unit.empty()) continue;
    unit = words;
    if (equals == std::string::npos) name.resize(name.size() - end.size());
  }
  if (equals == std::string::npos) std::replace(name.begin(), name.end(), '_', ' ');
  return name + (name.empty() ? "" : " ") + json_value_text(value) + (unit.empty() ? "" : " ") +
         std::string(unit);
}

/// Returns several quantities. @param quantities  arguments of quantity_text(), separated by commas
std::string quantities_text(const Json& table, const std::string& quantities) {
  std::string out;
  for (const std::string& quantity : CLI::detail::split(quantities, ',')) {
    const std::string part = quantity_text(table, quantity);
    if (!part.empty()) out += (out.empty() ? "" : ", ") + part;
  }
  return out;
}

void add_line(std::string& out, const std::string& name, const std::string& text) {
  if (!text.empty()) append(out, "{:<14} {}\n", name, text);
}

/// Adds the entries of a list, counted from 1.
void add_entries(std::string& out, const char* name, const Json& entries,
                 const std::string& quantities) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    add_line(out, fmt::format("{} {}", name, i + 1), quantities_text(entries[i], quantities));
  }
}

/// Returns the table with a single EI if both are equal.
Json one_stiffness(Json table) {
  Json& EI = table["bending_stiffness_Nm2"];
  if (EI.at(0) == EI.at(1)) EI = Json(EI.at(0));
  return table;
}

void add_rod(std::string& out, const Json& whole) {
  Json rod = one_stiffness(whole);
  for (Json& section : rod["sections"]) section = one_stiffness(section);
  add_line(
      out, "rod",
      quantities_text(rod, "length_m,diameter_m,inner_diameter_m,width_m,thickness_m,mass_kg"));
  add_line(out, "material",
           quantities_text(rod, "=material,E=youngs_modulus_Pa,density_kg_per_m3"));
  const bool of_no_effect = rod.at("torsional_stiffness_Nm2").is_null();
  const char* const GJ =
      of_no_effect ? "assumed_torsional_stiffness_Nm2" : "torsional_stiffness_Nm2";
  const bool assumed = of_no_effect || rod.at("torsional_stiffness_is_assumed") == true;
  add_line(out, "stiffness",
           quantities_text(
               rod, std::string("EI=bending_stiffness_Nm2,GJ=") + GJ + ",EA=axial_stiffness_N") +
               (assumed ? " (GJ is assumed, with Poisson's ratio 0.3" : "") +
               (of_no_effect ? ", and of no effect here)"
                : assumed    ? ")"
                             : ""));
  if (const Json& layers = rod.at("layers"); !layers.is_null()) {
    add_line(out, "layers",
             quantities_text(
                 layers,
                 "taken=bound,EI bonded=bonded_bending_stiffness_Nm2,EI free to "
                 "slip=free_bending_stiffness_Nm2,GJ bonded=bonded_torsional_stiffness_Nm2,GJ "
                 "free=free_torsional_stiffness_Nm2"));
  }
  add_line(out, "weight", quantities_text(rod, "mass_per_length_kg_per_m,mean_weight_N_per_m"));
  add_line(out, "free shape",
           quantities_text(
               rod, "curvature=natural_curvature_per_m,twist=natural_twist_rad_per_m,first_frame"));
  if (const Json& rest = rod.at("rest_shape"); !rest.is_null()) {
    add_line(out, "rest shape",
             quantities_text(rest,
                             "=file,points,arcs,error up to=largest_error_m,RMS=rms_error_m,d1 up "
                             "to=largest_angle_rad"));
    add_line(out, "  in its axes",
             quantities_text(rest, "begins at=begin_m,with frame=first_frame"));
  }
  add_entries(out, "section", rod.at("sections"),
              "from_m,to_m,EI=bending_stiffness_Nm2,GJ=torsional_stiffness_Nm2,mass_per_length_kg_"
              "per_m,curvature=natural_curvature_per_m,twist=natural_twist_rad_per_m");
}

void add_grippers(std::string& out, const Json& grippers) {
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    const Json& gripper = grippers[i];
    std::string text = fmt::format("at {} m, ", json_value_text(gripper.at("at_m")));
    text += quantities_text(gripper, "=hold,position_m,direction");
    if (!gripper.at("frame").is_null()) {
      const std::string frame = quantities_text(gripper.at("frame"), "d1,roll_rad");
      text += ", frame held" + (frame.empty() ? "" : ": " + frame);
    }
    add_line(out, fmt::format("gripper {}", i + 1), text);
  }
}

void add_force_model(std::string& out, const Json& model) {
  add_line(out, "force model",
           quantities_text(model, "N=points,law,joint_law,bookkeeping,stepper"));
  add_line(out, "  refused",
           model.at("refused").is_null() ? "" : json_value_text(model.at("refused")));
  add_line(
      out, "  derived",
      quantities_text(
          model, "segment=segment_length_m,c_c=c_c:N,c_b=c_b:N,c_F=c_F:m/N,c_h=c_h,l_s=l_s_m"));
  const auto range_of = [&](const char* name, const char* key, const char* unit) {
    if (!model.contains(key) || model.at(key).empty()) return;
    const std::vector<double> values = model.at(key).get<std::vector<double>>();
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    add_line(out, name,
             fmt::format("{} of {:.6g} to {:.6g} {}", values.size(), *least, *most, unit));
  };
  range_of("  points", "point_mass_kg", "kg");
  range_of("  segments", "segment_m", "m");
  range_of("  joints", "joint_stiffness_Nm", "N m (EI/h)");
}

/// Returns a scene's document (compare::scene_document) as text.
std::string scene_text(const Json& document) {
  std::string out;
  add_line(out, "scene", json_value_text(document.at("scene")));
  add_line(out, "file", json_value_text(document.at("file")));
  add_line(out, "gravity", json_value_text(document.at("gravity_m_per_s2")) + " m/s^2");
  add_line(out, "Gamma", json_value_text(document.at("gamma")) + "   (w l^3 / EI)");
  const Json& normal = document.at("plane_normal");
  add_line(out, "plane", normal.is_null() ? "none" : "normal " + json_value_text(normal));
  add_rod(out, document.at("rod"));
  add_grippers(out, document.at("grippers"));
  add_entries(out, "load", document.at("loads"), "at_m,force_N,torque_Nm,follows");
  add_entries(out, "distributed load", document.at("distributed_loads"),
              "from_m,to_m,force_per_length_N_per_m");
  if (document.contains("drag")) {
    add_entries(out, "drag", Json::array({document.at("drag")}),
                "velocity_m_per_s,normal_kg_per_m2,tangential_kg_per_m2");
  }
  add_entries(
      out, "obstacle", document.at("obstacles"),
      "=shape,point_m,normal,axis,axes,size_m,length_m,radius_m,stiffness_N_per_m2,friction");
  add_force_model(out, document.at("force_model"));
  return out;
}

struct ShowOptions {
  std::string scene;
  SceneOptions overrides;
  OutputOptions output;
};

void run(const ShowOptions& options) {
  const Json document = compare::scene_document(options.overrides.load(options.scene));
  write_output(options.output,
               options.output.is(Format::json) ? json_text(document) : scene_text(document));
}

}  // namespace

void add_scene(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "scene", "a scene in SI units with all that follows from it, for other programs");
  const auto options = std::make_shared<ShowOptions>();
  command->add_option("SCENE", options->scene, "scene file (TOML)")->required();
  options->overrides.add_settings_to(*command);
  add_output_options(*command, options->output, {"text", "json"});
  command->footer(
      "Examples:\n"
      "  dlo scene data/scenes/twisted_wire.toml\n"
      "  dlo scene data/scenes/spliced_cable.toml --points 32 -o scene.json");
  command->callback([options] { run(*options); });
}

}  // namespace dlo::cli
