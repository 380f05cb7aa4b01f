#include <fmt/format.h>

#include <optional>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "format/calibration_output.hpp"
#include "series/series_output.hpp"

namespace dlo::cli {
namespace {

using compare::MotionNumber;

Json motion_number_json(const MotionNumber& number) {
  return {{"value", number.identified ? Json(number.value) : Json()},
          {"low", number.low},
          {"high", number.high}};
}

}  // namespace

compare::Document motion_fit_document(const compare::MotionFit& fit, const compare::Scene& scene) {
  const auto marker_json = [](const compare::PartError& marker) -> Json {
    return {{"s_m", marker.from_m}, {"rms_m", marker.rms_m}};
  };
  const auto recording_json = [](const compare::FittedRecording& recording) -> Json {
    const compare::MotionErrors& errors = recording.errors;
    const compare::FrameError& worst = errors.frames[errors.worst_frame];
    return {{"file", recording.file},
            {"times", errors.frames.size()},
            {"from_s", errors.frames.front().time},
            {"to_s", errors.frames.back().time},
            {"rms_m", errors.rms_m},
            {"worst", {{"time_s", worst.time}, {"rms_m", worst.rms_m}}},
            {"starts_as_recorded", recording.starts_as_recorded}};
  };
  const compare::NamedValue given = scene.stiffness();
  Json stiffness = motion_number_json(fit.scene_stiffness);
  stiffness["name"] = given.name;
  stiffness["unit"] = given.unit;
  stiffness["scene"] = given.value;
  Json result = {{"schema", "dlo/motion_fit/1"},
                 {"recordings", compare::json_list(fit.recordings, recording_json)},
                 {"identified", fit.not_identified.empty()},
                 {"not_identified", fit.not_identified},
                 {"stiffness", stiffness},
                 {"stiffness_over_mass_m4_per_s2", motion_number_json(fit.stiffness)},
                 {"damping_s", json_or_null(fit.material, motion_number_json)},
                 {"drag_N_s_per_m2", json_or_null(fit.air, motion_number_json)},
                 {"quadratic_drag_N_s2_per_m3", json_or_null(fit.quadratic, motion_number_json)},
                 {"noise_m", fit.noise},
                 {"coordinates", fit.coordinates},
                 {"effective_coordinates", fit.effective_coordinates},
                 {"rms_m", fit.rms},
                 {"given_rms_m", fit.given_rms},
                 {"markers", compare::json_list(fit.by_marker, marker_json)},
                 {"terms", fit.terms},
                 {"simulations", fit.simulations}};
  return {.json = std::move(result)};
}

std::string motion_toml(const compare::MotionFit& fit, const compare::Scene& scene) {
  if (!fit.not_identified.empty()) {
    throw compare::ConvergenceError(
        fmt::format("calibrate: nothing is written, {} is not "
                    "identified: {}",
                    scene.stiffness().name, fit.not_identified));
  }
  const auto interval = [](const compare::MotionNumber& number) {
    return fmt::format("{}95 %: {:.4g} to {:.4g}", number.identified ? "" : "not identified, ",
                       number.low, number.high);
  };
  std::string out = "# Written by dlo calibrate, for --calibrated.\n";
  const auto add = [&](const char* key, const char* unit,
                       const std::optional<compare::MotionNumber>& number) {
    if (number) {
      append(out, "{} = {:.8e}  # {}, {}\n", key, number->value, unit, interval(*number));
    }
  };
  add("damping", "s", fit.material);
  add("drag", "N s/m^2", fit.air);
  add("quadratic_drag", "N s^2/m^3", fit.quadratic);
  add_rod_lines(
      out, scene, {fit.scene_stiffness.value, interval(fit.scene_stiffness)},
      {scene.mass_parameter().value, "from the scene"},
      fmt::format("least squares of {} recorded motion{}, noise {:.3g} m", fit.recordings.size(),
                  fit.recordings.size() == 1 ? "" : "s", fit.noise));
  return out;
}

}  // namespace dlo::cli
