#include "suite/pack.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <filesystem>
#include <system_error>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/output_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/solution.hpp"
#include "parallel/threads.hpp"
#include "record/field.hpp"
#include "record/solution_fields.hpp"
#include "shape/write_vtk.hpp"

namespace dlo::compare {
namespace {

constexpr const char* answer_schema_name = "dlo/answer/1";
constexpr const char* motion_schema_name = "dlo/motion/1";
constexpr const char* pack_schema_name = "dlo/pack/1";

/// Rounds to ten significant digits, and rounding errors to 0; returns NaN and infinity unchanged.
/// @param large  magnitude of such quantities in the scene
double rounded(double value, double large) {
  constexpr double rounding = 1e-11;
  if (!std::isfinite(value)) return value;
  if (std::abs(value) <= rounding * large) return 0;
  return as_number<double>(fmt::format("{:.10g}", value)).value();
}

/// Rounds a bound up to two digits. @param rounding  rounding error of the written values, which
/// the bound includes
double bound(double value, double rounding) {
  const double all = value + rounding;
  const auto two_digits = [](double x) { return *as_number<double>(fmt::format("{:.1e}", x)); };
  const double nearest = two_digits(all);
  if (!(nearest < all)) return nearest;
  return two_digits(nearest + std::pow(10, std::floor(std::log10(nearest)) - 1));
}

/// Returns the bound of a number, or of a vector, including the rounding to ten digits.
double bound_of_digits(double value, double size, double large) {
  constexpr double rounding = 5e-10;  // half a unit of the tenth digit of 1, the largest share
  return bound(value, rounding * std::max(size, large));
}

/// Number of decimals of lengths [m], in a motion also of times [s]. Those of a motion suffice for
/// its larger bounds.
constexpr int answer_decimals = 12;
constexpr int motion_decimals = 9;

/// Returns the bound of points whose coordinates are rounded.
double bound_of_points(double metres, int decimals, double unit = 1) {
  return bound(metres / unit, std::pow(10, -decimals) / unit);
}

/// Rounds to decimals; adding zero avoids -0.
double round_to_decimals(double value, int decimals) {
  return as_number<double>(fmt::format("{:.{}f}", value, decimals)).value() + 0.0;
}

Json places(const std::vector<double>& values, int decimals) {
  return json_list(values,
                   [&](double value) -> Json { return round_to_decimals(value, decimals); });
}

Json point_json(const Eigen::Vector3d& point, int decimals) {
  return places({point.x(), point.y(), point.z()}, decimals);
}

Json places(const Eigen::Matrix3Xd& points, int decimals) {
  return json_list(points.colwise(),
                   [&](const auto& point) { return point_json(point, decimals); });
}

Json answer_vector(const Eigen::Vector3d& vector, double large) {
  return {rounded(vector.x(), large), rounded(vector.y(), large), rounded(vector.z(), large)};
}

Json answer_energies(const SceneEnergies& energy, double large) {
  Json result = Json::object();
  for (const auto& [name, value] : numbers_of(energy_fields(), energy)) {
    result[name] = rounded(value, large);
  }
  return result;
}

Json answer_grippers(const Answer& answer, const Magnitudes& large) {
  Json result = Json::array();
  for (std::size_t i = 0; i < answer.first.grippers.size(); ++i) {
    const GripperLoad& load = answer.first.grippers[i];
    result.push_back({{"at_m", answer.battery_scene.scene.grippers[i].at},
                      {"force_N", answer_vector(load.force, large.force)},
                      {"force_bound_N",
                       bound_of_digits(answer.bounds.forces_N[i], load.force.norm(), large.force)},
                      {"torque_Nm", answer_vector(load.torque, large.torque)},
                      {"torque_bound_Nm", bound_of_digits(answer.bounds.torques_Nm[i],
                                                          load.torque.norm(), large.torque)}});
  }
  return result;
}

Json answer_obstacles(const Answer& answer, const Magnitudes& large) {
  Json result = Json::array();
  for (std::size_t i = 0; i < answer.first.obstacles.size(); ++i) {
    Json contacts = Json::array();
    for (const energy_model::ContactPart& part : answer.first.contacts) {
      if (part.obstacle != i) continue;
      contacts.push_back({{"kind", energy_model::to_string(part.kind)},
                          {"from_m", rounded(part.begin, large.length)},
                          {"to_m", rounded(part.end, large.length)},
                          {"force_N", answer_vector(part.force, large.force)}});
    }
    result.push_back(
        {{"force_N", answer_vector(answer.first.obstacles[i], large.force)},
         {"force_bound_N", bound_of_digits(answer.bounds.obstacles_N[i],
                                           answer.first.obstacles[i].norm(), large.force)},
         {"contacts", std::move(contacts)}});
  }
  return result;
}

Json answer_closed_form(const Answer& answer) {
  if (!answer.battery_scene.closed_form) return {};
  const ClosedForm& form = *answer.battery_scene.closed_form;
  return {{"is", form.formula},
          {"at_m", form.at},
          {"point_m", point_json(form.point, answer_decimals)}};
}

/// Writes one line for each key, and for each row of a list of lists or objects.
void write_document(const std::filesystem::path& file, const Json& document) {
  std::string text;
  for (const auto& [key, value] : document.items()) {
    text += (text.empty() ? "{\n " : ",\n ") + Json(key).dump() + ": ";
    const bool is_list = value.is_array() && !value.empty() && value.front().is_structured();
    if (!is_list) {
      text += value.dump();
      continue;
    }
    for (const Json& row : value) text += (&row == &value.front() ? "[\n  " : ",\n  ") + row.dump();
    text += "]";
  }
  write_file(file, text + "\n}\n");
}

/// Whether a JSON file names a schema, as "schema" or at the beginning of "title".
bool has_schema(const std::filesystem::path& file, std::string_view schema) {
  try {
    const Json document = Json::parse(read_regular_file(file, file));
    return document.value("schema", document.value("title", "")).starts_with(schema);
  } catch (const nlohmann::json::exception&) {
    return false;
  } catch (const InputError&) {
    return false;
  }
}

/// Returns the points of an answer as x,y,z,s, which `dlo check` reads as a shape.
std::string answer_csv(const Answer& answer) {
  std::string text = "x,y,z,s\n";
  const Shape& shape = answer.first.shape;
  for (std::size_t i = 0; i < shape.arc_length.size(); ++i) {
    for (const double x : shape.points.col(static_cast<Eigen::Index>(i))) {
      text += fmt::format("{:.12f},", round_to_decimals(x, answer_decimals));
    }
    text += fmt::format("{:.12f}\n", round_to_decimals(shape.arc_length[i], answer_decimals));
  }
  return text;
}

/// Returns the points of an answer in VTK's XML format, for ParaView.
std::string answer_vtu(const Answer& answer) {
  Shape shape = answer.first.shape;
  for (double& x : shape.points.reshaped()) x = round_to_decimals(x, answer_decimals);
  for (double& s : shape.arc_length) s = round_to_decimals(s, answer_decimals);
  return vtu_polyline(shape);
}

/// Returns the frames of a motion as time,s,x,y,z, which `dlo check --motion` reads as a recording.
std::string motion_csv(const MotionAnswer& answer) {
  std::string text = "time,s,x,y,z\n";
  for (std::size_t k = 0; k < answer.times.size(); ++k) {
    for (std::size_t i = 0; i < answer.arc_length.size(); ++i) {
      const Eigen::Vector3d point = answer.frames[k].col(static_cast<Eigen::Index>(i));
      std::vector<double> row = {answer.times[k], answer.arc_length[i], point.x(), point.y(),
                                 point.z()};
      for (double& value : row) value = round_to_decimals(value, motion_decimals);
      text += fmt::format("{}\n", fmt::join(row, ","));
    }
  }
  return text;
}

}  // namespace

nlohmann::ordered_json answer_json(const Answer& answer) {
  const Solution& first = answer.first;
  const Scene& scene = answer.battery_scene.scene;
  const Magnitudes large = magnitudes(scene);
  Json result = {{"schema", answer_schema_name},
                 {"id", answer.battery_scene.id},
                 {"class", answer.battery_scene.group},
                 {"name", scene.name},
                 {"isolates", answer.battery_scene.isolates},
                 {"closed_form", answer_closed_form(answer)},
                 {"length_m", scene.length},
                 {"gamma", rounded(scene.gamma(), 0)},
                 {"methods", {to_string(first.model), answer.second_method}},
                 {"status", status_name(first.status)},
                 {"lowest", scene.stretch != Stretch::none ? Json() : Json(answer.is_lowest)},
                 {"smallest_eigenvalue", rounded(first.smallest_eigenvalue, 1)},
                 {"energy", answer_energies(first.energy, large.energy)},
                 {"energy_bound_J", bound_of_digits(answer.bounds.energy_J,
                                                    std::abs(first.energy.total()), large.energy)},
                 {"grippers", answer_grippers(answer, large)},
                 {"obstacles", answer_obstacles(answer, large)}};
  constexpr double rounding_scale = 1e6;
  result["other_equilibria"] = json_list(answer.others, [&](const OtherEquilibrium& other) -> Json {
    const auto short_number = [&](double value, double of) {
      return std::round(value / of * rounding_scale) / rounding_scale * of;
    };
    return {{"energy_J", rounded(short_number(other.energy_J, large.energy), large.energy)},
            {"stable", other.stable},
            {"apart_over_length",
             rounded(short_number(other.distance_m, scene.length) / scene.length, 1)}};
  });
  result["points_bound_m"] = bound_of_points(answer.bounds.points_m, answer_decimals);
  result["arc_length_m"] = places(first.shape.arc_length, answer_decimals);
  result["points_m"] = places(first.shape.points, answer_decimals);
  return result;
}

nlohmann::ordered_json motion_json(const MotionAnswer& answer) {
  return {{"schema", motion_schema_name},
          {"id", answer.battery_scene.id},
          {"class", answer.battery_scene.group},
          {"name", answer.battery_scene.scene.name},
          {"isolates", answer.battery_scene.isolates},
          {"length_m", answer.battery_scene.scene.length},
          {"gamma", rounded(answer.battery_scene.scene.gamma(), 1)},
          {"methods", {to_string(Model::energy), answer.second_method}},
          {"points_bound_m", bound_of_points(answer.points_bound_m, motion_decimals)},
          {"times_s", places(answer.times, motion_decimals)},
          {"arc_length_m", places(answer.arc_length, motion_decimals)},
          {"frames_m", json_list(answer.frames, [](const Eigen::Matrix3Xd& frame) {
             return places(frame, motion_decimals);
           })}};
}

Pack certified_pack(const std::string& version, const std::vector<BatteryScene>& scenes,
                    int threads) {
  Pack pack{version, {}, {}};
  for (const BatteryScene& scene : scenes) {
    if (scene.motion) {
      pack.motions.push_back({.battery_scene = scene});
    } else {
      pack.answers.push_back({.battery_scene = scene});
    }
  }
  tbb::task_arena arena(arena_threads(threads));
  const auto certify = [&](auto& answers, const auto& certified) {
    execute(arena, [&] {
      tbb::parallel_for(std::size_t{0}, answers.size(),
                        [&](std::size_t i) { answers[i] = certified(answers[i].battery_scene); });
    });
  };
  certify(pack.answers, certified_answer);
  certify(pack.motions, certified_motion);
  return pack;
}

void require_own_pack(const std::string& folder, const std::vector<BatteryScene>& scenes) {
  const std::filesystem::path path(folder);
  const auto require = [&](const std::string& name, bool is_own_file) {
    std::error_code unknown;
    const auto type = std::filesystem::symlink_status(path / name, unknown).type();
    if (is_own_file || type == std::filesystem::file_type::not_found) return;
    throw InputError(fmt::format(
        "{}: not written by an earlier dlo suite --write, left as it is (allowed: another folder)",
        (path / name).string()));
  };
  for (const BatteryScene& scene : scenes) {
    const std::string answer = scene.id + ".json";
    const bool is_own_file =
        has_schema(path / answer, scene.motion ? motion_schema_name : answer_schema_name);
    for (const char* extension : {".json", ".csv", ".vtu"})
      require(scene.id + extension, is_own_file);
  }
  require("suite.json", has_schema(path / "suite.json", pack_schema_name));
  require("schema.json", has_schema(path / "schema.json", answer_schema_name));
  require("motion_schema.json", has_schema(path / "motion_schema.json", motion_schema_name));
}

void write_pack(const std::string& folder, const Pack& pack) {
  const std::filesystem::path path(folder);
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw OutputError(fmt::format("{}: {}", folder, error.message()));
  Json index = {{"schema", pack_schema_name},
                {"version", pack.version},
                {"unit", "SI"},
                {"answers", Json::array()}};
  const auto write = [&](const BatteryScene& scene, const Json& document, const std::string& csv,
                         double bound_over_length) {
    write_document(path / (scene.id + ".json"), document);
    write_file(path / (scene.id + ".csv"), csv);
    index["answers"].push_back({{"id", scene.id},
                                {"class", scene.group},
                                {"isolates", scene.isolates},
                                {"answer", scene.id + ".json"},
                                {"points", scene.id + ".csv"},
                                {"points_bound_over_length", bound_over_length}});
  };
  for (const Answer& answer : pack.answers) {
    const BatteryScene& scene = answer.battery_scene;
    write(scene, answer_json(answer), answer_csv(answer),
          bound_of_points(answer.bounds.points_m, answer_decimals, scene.scene.length));
    write_file(path / (scene.id + ".vtu"), answer_vtu(answer));
  }
  for (const MotionAnswer& answer : pack.motions) {
    const BatteryScene& scene = answer.battery_scene;
    write(scene, motion_json(answer), motion_csv(answer),
          bound_of_points(answer.points_bound_m, motion_decimals, scene.scene.length));
  }
  for (const char* schema : {"schema.json", "motion_schema.json"}) {
    write_file(path / schema, builtin_file(schema));
  }
  write_document(path / "suite.json", index);
}

}  // namespace dlo::compare
