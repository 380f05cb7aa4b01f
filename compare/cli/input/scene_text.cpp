#include "input/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/display.hpp"
#include "option/output.hpp"

namespace dlo::cli {
namespace {

/// A quantity of a table of the document.
struct Quantity {
  const char* name;
  const char* key;
  const char* unit;
};

/// Numbers with six digits, lists of them in brackets, words as they are.
std::string json_value_text(const Json& value) {
  if (value.is_string()) return compare::display(value.get<std::string>());
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string out;
  for (const Json& entry : value) out += (out.empty() ? "" : ", ") + json_value_text(entry);
  return "[" + out + "]";
}

/// "NAME VALUE UNIT", or nothing for what the scene does not have.
std::string quantity_text(const Json& table, const Quantity& quantity) {
  if (!table.contains(quantity.key)) return "";
  const Json& value = table.at(quantity.key);
  const bool nothing = value.is_null() || value == 0.0 || (value.is_array() && value.empty());
  if (nothing) return "";
  std::string out = json_value_text(value);
  if (*quantity.name != '\0') out = fmt::format("{} {}", quantity.name, out);
  if (*quantity.unit != '\0') out += fmt::format(" {}", quantity.unit);
  return out;
}

std::string quantities_text(const Json& table, const std::vector<Quantity>& quantities) {
  std::string out;
  for (const Quantity& quantity : quantities) {
    const std::string part = quantity_text(table, quantity);
    if (!part.empty()) out += (out.empty() ? "" : ", ") + part;
  }
  return out;
}

void add_line(std::string& out, const std::string& name, const std::string& text) {
  if (!text.empty()) append(out, "{:<14} {}\n", name, text);
}

/// A list's entries, counted from 1.
void add_entries(std::string& out, const char* name, const Json& entries,
                 const std::vector<Quantity>& quantities) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    add_line(out, fmt::format("{} {}", name, i + 1), quantities_text(entries[i], quantities));
  }
}

/// With one EI where both are the same.
Json one_stiffness(Json table) {
  Json& EI = table["bending_stiffness_Nm2"];
  if (EI.at(0) == EI.at(1)) EI = Json(EI.at(0));
  return table;
}

void add_rod(std::string& out, const Json& whole) {
  Json rod = one_stiffness(whole);
  for (Json& section : rod["sections"]) section = one_stiffness(section);
  add_line(out, "rod",
           quantities_text(rod, {{"length", "length_m", "m"},
                                 {"diameter", "diameter_m", "m"},
                                 {"inner diameter", "inner_diameter_m", "m"},
                                 {"width", "width_m", "m"},
                                 {"thickness", "thickness_m", "m"},
                                 {"mass", "mass_kg", "kg"}}));
  add_line(out, "material",
           quantities_text(rod, {{"", "material", ""},
                                 {"E", "youngs_modulus_Pa", "Pa"},
                                 {"density", "density_kg_per_m3", "kg/m^3"}}));
  const bool of_no_effect = rod.at("torsional_stiffness_Nm2").is_null();
  const char* const GJ =
      of_no_effect ? "assumed_torsional_stiffness_Nm2" : "torsional_stiffness_Nm2";
  const bool assumed = of_no_effect || rod.at("torsional_stiffness_is_assumed") == true;
  add_line(out, "stiffness",
           quantities_text(rod, {{"EI", "bending_stiffness_Nm2", "N m^2"},
                                 {"GJ", GJ, "N m^2"},
                                 {"EA", "axial_stiffness_N", "N"}}) +
               (assumed ? " (GJ is assumed, with Poisson's ratio 0.3" : "") +
               (of_no_effect ? ", and of no effect here)"
                : assumed    ? ")"
                             : ""));
  if (const Json& layers = rod.at("layers"); !layers.is_null()) {
    add_line(out, "layers",
             quantities_text(layers, {{"taken", "bound", ""},
                                      {"EI bonded", "bonded_bending_stiffness_Nm2", "N m^2"},
                                      {"EI free to slip", "free_bending_stiffness_Nm2", "N m^2"},
                                      {"GJ bonded", "bonded_torsional_stiffness_Nm2", "N m^2"},
                                      {"GJ free", "free_torsional_stiffness_Nm2", "N m^2"}}));
  }
  add_line(out, "weight",
           quantities_text(rod, {{"mass per length", "mass_per_length_kg_per_m", "kg/m"},
                                 {"mean weight", "mean_weight_N_per_m", "N/m"}}));
  add_line(out, "free shape",
           quantities_text(rod, {{"curvature", "natural_curvature_per_m", "1/m"},
                                 {"twist", "natural_twist_rad_per_m", "rad/m"},
                                 {"first frame", "first_frame", ""}}));
  if (const Json& rest = rod.at("rest_shape"); !rest.is_null()) {
    add_line(out, "rest shape",
             quantities_text(rest, {{"", "file", ""},
                                    {"points", "points", ""},
                                    {"arcs", "arcs", ""},
                                    {"error up to", "largest_error_m", "m"},
                                    {"RMS", "rms_error_m", "m"},
                                    {"d1 up to", "largest_angle_rad", "rad"}}));
    add_line(
        out, "  in its axes",
        quantities_text(rest, {{"begins at", "begin_m", "m"}, {"with frame", "first_frame", ""}}));
  }
  add_entries(out, "section", rod.at("sections"),
              {{"from", "from_m", "m"},
               {"to", "to_m", "m"},
               {"EI", "bending_stiffness_Nm2", "N m^2"},
               {"GJ", "torsional_stiffness_Nm2", "N m^2"},
               {"mass per length", "mass_per_length_kg_per_m", "kg/m"},
               {"curvature", "natural_curvature_per_m", "1/m"},
               {"twist", "natural_twist_rad_per_m", "rad/m"}});
}

void add_grippers(std::string& out, const Json& grippers) {
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    const Json& gripper = grippers[i];
    std::string text = fmt::format("at {} m, ", json_value_text(gripper.at("at_m")));
    text += quantities_text(
        gripper,
        {{"", "hold", ""}, {"position", "position_m", "m"}, {"direction", "direction", ""}});
    if (!gripper.at("frame").is_null()) {
      const std::string frame =
          quantities_text(gripper.at("frame"), {{"d1", "d1", ""}, {"roll", "roll_rad", "rad"}});
      text += ", frame held" + (frame.empty() ? "" : ": " + frame);
    }
    add_line(out, fmt::format("gripper {}", i + 1), text);
  }
}

void add_force_model(std::string& out, const Json& model) {
  add_line(out, "force model",
           quantities_text(model, {{"N", "points", ""},
                                   {"law", "law", ""},
                                   {"joint law", "joint_law", ""},
                                   {"bookkeeping", "bookkeeping", ""},
                                   {"stepper", "stepper", ""}}));
  add_line(out, "  refused",
           model.at("refused").is_null() ? "" : json_value_text(model.at("refused")));
  add_line(out, "  derived",
           quantities_text(model, {{"segment", "segment_length_m", "m"},
                                   {"c_c", "c_c", "N"},
                                   {"c_b", "c_b", "N"},
                                   {"c_F", "c_F", "m/N"},
                                   {"c_h", "c_h", ""},
                                   {"l_s", "l_s_m", "m"}}));
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

}  // namespace

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
  add_entries(out, "load", document.at("loads"),
              {{"at", "at_m", "m"},
               {"force", "force_N", "N"},
               {"torque", "torque_Nm", "N m"},
               {"follows", "follows", ""}});
  add_entries(out, "distributed load", document.at("distributed_loads"),
              {{"from", "from_m", "m"},
               {"to", "to_m", "m"},
               {"force per length", "force_per_length_N_per_m", "N/m"}});
  if (document.contains("drag")) {
    add_entries(out, "drag", Json::array({document.at("drag")}),
                {{"velocity", "velocity_m_per_s", "m/s"},
                 {"normal", "normal_kg_per_m2", "kg/m^2"},
                 {"tangential", "tangential_kg_per_m2", "kg/m^2"}});
  }
  add_entries(out, "obstacle", document.at("obstacles"),
              {{"", "shape", ""},
               {"point", "point_m", "m"},
               {"normal", "normal", ""},
               {"axis", "axis", ""},
               {"axes", "axes", ""},
               {"size", "size_m", "m"},
               {"length", "length_m", "m"},
               {"radius", "radius_m", "m"},
               {"stiffness", "stiffness_N_per_m2", "N/m^2"},
               {"friction", "friction", ""}});
  add_force_model(out, document.at("force_model"));
  return out;
}

}  // namespace dlo::cli
