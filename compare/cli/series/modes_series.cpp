#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/number.hpp"
#include "base/text.hpp"
#include "format/result_output.hpp"
#include "option/output.hpp"
#include "record/csv_table.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::SceneMode;

double hertz(double omega) { return omega / (2 * std::numbers::pi); }

std::string frequency_text(const energy_model::VibrationMode& mode) {
  if (mode.omega_squared >= 0) return fmt::format("{:.6g} Hz", hertz(mode.omega()));
  return fmt::format("unstable, e-fold in {:.3g} s", 1 / std::sqrt(-mode.omega_squared));
}

std::string line_of(const SceneMode& mode, std::size_t number) {
  std::string out = fmt::format("mode {:<6} {}, {}", number + 1, frequency_text(mode.rod),
                                to_string(mode.rod.plane));
  const double omega = mode.rod.omega();
  if (mode.polygon_omega) {
    append(out, "; polygon {:.6g} Hz ({:+.3g} %)", hertz(*mode.polygon_omega),
           (*mode.polygon_omega / omega - 1) * 100);
    constexpr double alike = 0.9;
    if (mode.polygon_likeness < alike) {
      append(out, ", moves {:.0f} % like it", mode.polygon_likeness * 100);
    }
  }
  if (!mode.stepped) return out + "\n";
  if (mode.stepped->omega > 0) {
    append(out, "; as it steps {:.4g} Hz ({:.4g} times), damping ratio {:.3g}",
           hertz(mode.stepped->omega), mode.stepped->omega / omega, mode.stepped->damping);
  } else {
    out += "; overdamped as it steps";
  }
  return out + (mode.stepped->is_stable ? "\n" : ", unstable\n");
}

Json mode_json(const SceneMode& mode, const std::vector<double>& s) {
  const bool stable = mode.rod.omega_squared >= 0;
  const double omega = mode.rod.omega();
  Json result = {{"frequency_Hz", stable ? Json(hertz(omega)) : Json(nullptr)},
                 {"omega_rad_s", stable ? Json(omega) : Json(nullptr)},
                 {"omega_squared_per_s2", mode.rod.omega_squared},
                 {"relative_error", mode.rod.error},
                 {"plane", to_string(mode.rod.plane)},
                 {"from_m", mode.rod.begin},
                 {"to_m", mode.rod.end}};
  result["polygon_frequency_Hz"] =
      mode.polygon_omega ? Json(hertz(*mode.polygon_omega)) : Json(nullptr);
  result["polygon_likeness"] = mode.polygon_omega ? Json(mode.polygon_likeness) : Json(nullptr);
  result["stepped"] = json_or_null(mode.stepped, [](const auto& stepped) -> Json {
    return {{"frequency_Hz", hertz(stepped.omega)},
            {"damping_ratio", stepped.damping},
            {"stable", stepped.is_stable}};
  });
  result["shape_m"] = points_json(mode.rod.shape(s));
  return result;
}

}  // namespace

std::string modes_text(const compare::SceneModes& modes, const compare::Scene& scene, double rate) {
  std::string out = fmt::format("scene       {}\n", compare::display(scene.name));
  for (std::size_t i = 0; i < modes.modes.size(); ++i) out += line_of(modes.modes[i], i);
  if (modes.tension) {
    append(out, "tension     {:g} N, which is not identifiable from the shape (--tension)\n",
           compare::shown(*modes.tension, magnitudes(scene).force));
  }
  if (!modes.no_polygon.empty()) {
    append(out, "polygon     none: {}\n", modes.no_polygon);
    return out;
  }
  const compare::PhysicalSteps& physical = *modes.physical;
  append(out, "points      {:.4g} kg each in the mean ({} of them)\n", physical.point_mass,
         scene.force_model.points);
  if (modes.mass_of_steps) {
    append(out, "stepper     m* = {:.4g} kg at {:g} steps a second, {:.3g} times the points'\n",
           *modes.mass_of_steps, rate, *modes.mass_of_steps / physical.point_mass);
  }
  const bool stable = rate >= physical.least_rate;
  append(out, "physical    c_F = {:.4g} m/N, c_h = {:.9g} at {:g} steps a second: {}\n",
         physical.c_F, physical.c_h, rate, stable ? "stable" : "unstable");
  append(out, "            (stable from {:.4g} steps a second on)\n", physical.least_rate);
  return out;
}

Json modes_json(const compare::SceneModes& modes, const compare::Scene& scene, double rate,
                int samples) {
  const std::vector<double> s = energy_model::equal_arc_lengths(scene.length, samples);
  Json result = {{"schema", "dlo/modes/1"},
                 {"scene", scene.name},
                 {"model", "energy"},
                 {"status", to_string(modes.status)},
                 {"steps_per_second", rate},
                 {"arc_length_m", s},
                 {"modes", json_list(modes.modes, [&](const SceneMode& mode) -> Json {
                    return mode_json(mode, s);
                  })}};
  result["tension_N"] = json_or_null(modes.tension);
  result["no_polygon"] = text_or_null(modes.no_polygon);
  result["mass_of_steps_kg"] = json_or_null(modes.mass_of_steps);
  result["physical"] = json_or_null(modes.physical, [](const auto& physical) -> Json {
    return {{"point_mass_kg", physical.point_mass},
            {"c_F_m_per_N", physical.c_F},
            {"c_h", physical.c_h},
            {"least_steps_per_second", physical.least_rate}};
  });
  return result;
}

std::string modes_csv(const compare::SceneModes& modes) {
  const compare::CsvTable table(
      "mode,frequency_Hz,omega_squared_per_s2,plane,from_m,to_m,polygon_frequency_Hz,"
      "stepped_frequency_Hz=stepped/frequency_Hz,stepped_damping_ratio=stepped/damping_ratio");
  std::string out = table.header();
  for (std::size_t i = 0; i < modes.modes.size(); ++i) {
    Json row = mode_json(modes.modes[i], {0.0});
    row["mode"] = i + 1;
    out += table.row(row);
  }
  return out;
}

}  // namespace dlo::cli
