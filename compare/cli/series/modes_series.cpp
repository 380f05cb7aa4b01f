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
  result["polygon_frequency_Hz"] = json_or_null(mode.polygon_omega, hertz);
  result["polygon_likeness"] = mode.polygon_omega ? Json(mode.polygon_kinetic_share) : Json();
  result["stepped"] = json_or_null(mode.stepped, [](const auto& stepped) -> Json {
    return {{"frequency_Hz", hertz(stepped.omega)},
            {"damping_ratio", stepped.damping},
            {"stable", stepped.is_stable}};
  });
  result["shape_m"] = points_json(mode.rod.shape(s));
  return result;
}

}  // namespace

compare::Document modes_document(const compare::SceneModes& modes, const compare::Scene& scene,
                                 double rate, int samples) {
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
  result["no_polygon"] = text_or_null(modes.missing_polygon_reason);
  result["mass_of_steps_kg"] = json_or_null(modes.effective_point_mass);
  result["physical"] = json_or_null(modes.physical, [](const auto& physical) -> Json {
    return {{"point_mass_kg", physical.point_mass},
            {"c_F_m_per_N", physical.c_F},
            {"c_h", physical.c_h},
            {"least_steps_per_second", physical.least_rate}};
  });
  return {
      std::move(result),
      {{"modes",
        "mode=#,frequency_Hz,omega_squared_per_s2,plane,from_m,to_m,polygon_frequency_Hz,"
        "stepped_frequency_Hz=stepped/frequency_Hz,stepped_damping_ratio=stepped/damping_ratio"}},
      magnitudes(scene),
      "modes"};
}

}  // namespace dlo::cli
