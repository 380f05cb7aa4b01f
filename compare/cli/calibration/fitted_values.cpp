#include "calibration/fitted_values.hpp"

#include <numbers>

#include "base/quote.hpp"

namespace dlo::cli {

Key stiffness_key(const compare::Scene& scene) {
  return scene.given_bending_stiffness ? Key{"bending_stiffness", "_Nm2"}
                                       : Key{"youngs_modulus", "_Pa"};
}

Key heaviness_key(const compare::Scene& scene) {
  return scene.given_mass_per_length ? Key{"mass_per_length", "_kg_per_m"}
                                     : Key{"density", "_kg_per_m3"};
}

Key torsion_key() { return {"torsional_stiffness", "_Nm2"}; }

std::vector<ShownValue> fitted_values(const compare::Calibration& report) {
  const compare::Scene& scene = report.scenes.front();
  const compare::MaterialFit& fit = report.fit;
  std::vector<ShownValue> values = {
      {scene.stiffness(), stiffness_key(scene), "", fit.youngs_modulus}};
  const auto add = [&](const compare::NamedValue& said, const Key& key,
                       const std::optional<compare::FittedValue>& value) {
    if (value) values.push_back({said, key, key.name + "_", *value});
  };
  const double GJ = scene.twisting_stiffness();
  add(scene.heaviness(), heaviness_key(scene), fit.density);
  add({"GJ", "N m^2", GJ}, torsion_key(), fit.torsional_stiffness);
  add({"GJ / EI", "", GJ / scene.mean_bending_stiffness()},
      {"torsional_over_bending_stiffness", ""}, fit.torsion_over_bending);
  return values;
}

std::string interval_text(const compare::FittedValue& value) {
  const auto end = [](const std::optional<double>& at) {
    return at ? fmt::format("{:.4g}", *at) : "...";
  };
  return fmt::format("95 %: {} to {}", end(value.low), end(value.high));
}

std::string option_words(const compare::FitAlternative& alternative) {
  std::string out;
  const auto add = [&](double number, const char* option, double unit, const char* name) {
    if (!(number > 0)) return;
    compare::append(out, " {} \"{:.3g} {}\"", option, number / unit, name);
  };
  constexpr double degree = std::numbers::pi / 180;
  if (alternative.natural_curvature_terms > 0) {
    compare::append(out, " --natural-curvature {}", alternative.natural_curvature_terms);
  }
  add(alternative.direction_tolerance, "--clamp-angles", degree, "deg");
  add(alternative.position_tolerance, "--clamp-positions", 1e-3, "mm");
  if (alternative.shared_clamps) out += " --same-clamps";
  add(alternative.direction_scatter, "--clamp-scatter", degree, "deg");
  add(alternative.camera_tilt, "--camera-tilt", degree, "deg");
  return out.empty() ? out : out.substr(1);
}

}  // namespace dlo::cli
