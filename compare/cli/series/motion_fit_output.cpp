#include "series/motion_fit_output.hpp"

#include <fmt/format.h>

#include <optional>

namespace dlo::cli {
namespace {

using compare::MotionNumber;

std::string number_text(const MotionNumber& number, const char* unit) {
  return fmt::format("{:.5g} {}, 95 %: {:.4g} to {:.4g} {}", number.value, unit, number.low,
                     number.high, unit);
}

Json motion_number_json(const MotionNumber& number) {
  return {{"value", number.value}, {"low", number.low}, {"high", number.high}};
}

}  // namespace

std::string motion_fit_text(const compare::MotionFit& fit, const compare::Scene& scene) {
  const compare::NamedValue given = scene.stiffness();
  std::string out;
  append(out, "{:12}{}   (scene: {:.4g} {}), with the scene's {}\n", given.name,
         number_text(fit.scene_stiffness, given.unit), given.value, given.unit,
         scene.heaviness().name);
  append(out, "            over the mass per length, which motion alone shows: {}\n",
         number_text(fit.stiffness, "m^4/s^2"));
  const auto line = [&](const std::optional<MotionNumber>& number, const char* name,
                        const char* unit) {
    if (number) append(out, "{:12}{}\n", name, number_text(*number, unit));
  };
  line(fit.material, "damping", "s");
  line(fit.air, "drag", "N s/m^2");
  line(fit.quadratic, "quadratic", "N s^2/m^3");
  append(out, "noise       {:.4g} mm in each coordinate, estimated from the residuals\n",
         fit.noise * 1e3);
  append(out,
         "            {} coordinates count as {:.4g} independent ones: residuals are correlated in "
         "time\n",
         fit.coordinates, fit.effective_coordinates);
  append(out, "residual    {:.4g} mm between markers and rod (RMS), {:.4g} mm as the scene was\n",
         fit.rms * 1e3, fit.given_rms * 1e3);
  append(out, "            worst at {:.6g} s: {:.4g} mm\n", fit.worst.at, fit.worst.rms * 1e3);
  for (const compare::MarkerError& marker : fit.by_marker) {
    append(out, "            marker at s = {:.4g} m: {:.4g} mm\n", marker.at, marker.rms * 1e3);
  }
  append(out, "motion      {}: {} markers at {} times, {:.6g} to {:.6g} s\n", fit.file, fit.markers,
         fit.times, fit.from, fit.to);
  append(out, "            from {}; {} terms, {} simulations\n",
         fit.in_motion ? "motion with the grippers" : "rest", fit.terms, fit.simulations);
  return out;
}

Json motion_fit_json(const compare::MotionFit& fit, const compare::Scene& scene) {
  const auto optional = [](const std::optional<MotionNumber>& number) {
    return number ? motion_number_json(*number) : Json(nullptr);
  };
  Json markers = Json::array();
  for (const compare::MarkerError& marker : fit.by_marker) {
    markers.push_back({{"s_m", marker.at}, {"rms_m", marker.rms}});
  }
  const compare::NamedValue given = scene.stiffness();
  Json stiffness = motion_number_json(fit.scene_stiffness);
  stiffness["name"] = given.name;
  stiffness["unit"] = given.unit;
  stiffness["scene"] = given.value;
  return {{"schema", "dlo/motion_fit/1"},
          {"file", fit.file},
          {"stiffness", stiffness},
          {"stiffness_over_mass_m4_per_s2", motion_number_json(fit.stiffness)},
          {"damping_s", optional(fit.material)},
          {"drag_N_s_per_m2", optional(fit.air)},
          {"quadratic_drag_N_s2_per_m3", optional(fit.quadratic)},
          {"noise_m", fit.noise},
          {"coordinates", fit.coordinates},
          {"effective_coordinates", fit.effective_coordinates},
          {"rms_m", fit.rms},
          {"given_rms_m", fit.given_rms},
          {"worst", {{"time_s", fit.worst.at}, {"rms_m", fit.worst.rms}}},
          {"markers", markers},
          {"times", fit.times},
          {"from_s", fit.from},
          {"to_s", fit.to},
          {"in_motion", fit.in_motion},
          {"terms", fit.terms},
          {"simulations", fit.simulations}};
}

}  // namespace dlo::cli
