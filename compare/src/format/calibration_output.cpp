#include "format/calibration_output.hpp"

#include <algorithm>
#include <numbers>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material_fit.hpp"

namespace dlo::cli {

Key stiffness_key(const compare::Scene& scene) {
  return scene.given_bending_stiffness ? Key{"bending_stiffness", "_Nm2"}
                                       : Key{"youngs_modulus", "_Pa"};
}

Key mass_parameter_key(const compare::Scene& scene) {
  return scene.given_mass_per_length ? Key{"mass_per_length", "_kg_per_m"}
                                     : Key{"density", "_kg_per_m3"};
}

Key torsion_key() { return {"torsional_stiffness", "_Nm2"}; }

std::vector<ShownValue> fitted_values(const compare::Calibration& report) {
  const compare::Scene& scene = report.scenes.front();
  const compare::MaterialFit& fit = report.fit;
  std::vector<ShownValue> values = {
      {scene.stiffness(), stiffness_key(scene), "", fit.youngs_modulus}};
  const auto add = [&](const compare::NamedValue& quantity, const Key& key,
                       const std::optional<compare::FittedValue>& value) {
    if (value) values.push_back({quantity, key, key.name + "_", *value});
  };
  const double GJ = scene.twisting_stiffness();
  add(scene.mass_parameter(), mass_parameter_key(scene), fit.density);
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

compare::Json chains_json(const std::vector<compare::ChainSprings>& chains) {
  compare::Json result = compare::Json::array();
  for (const compare::ChainSprings& chain : chains) {
    result.push_back({{"scene", chain.scene},
                      {"clamp", compare::to_string(chain.clamp)},
                      {"segments", chain.segments},
                      {"segment_length_m", chain.segment_length},
                      {"joint_stiffness_Nm_per_rad", chain.stiffness},
                      {"binormal_stiffness_Nm_per_rad", chain.binormal_stiffness},
                      {"over_bending_stiffness_per_length", chain.stiffness_ratio},
                      {"rms_m", chain.rms_m}});
    if (!chain.joints.empty()) {
      result.back()["segment_lengths_m"] = chain.segment_lengths;
      result.back()["joints"] =
          compare::json_list(chain.joints, [](const compare::ChainJoint& joint) -> compare::Json {
            return {{"at_m", joint.at},
                    {"joint_stiffness_Nm_per_rad", joint.stiffness},
                    {"binormal_stiffness_Nm_per_rad", joint.binormal_stiffness}};
          });
    }
  }
  return result;
}

namespace {

using compare::append;
using compare::FittedValue;

/// Returns a vector as in a scene file.
std::string vector_text(const Eigen::Vector3d& v) {
  return compare::formatted("[{:.6e}, {:.6e}, {:.6e}]", v.x(), v.y(), v.z());
}

/// Returns the natural curvature as in a scene file [1/m].
std::string natural_curvature_text(const compare::MaterialFit& fit) {
  std::string out;
  for (const Eigen::Vector2d& term : fit.natural_curvature) {
    append(out, "{}[{:.6e}, {:.6e}]", out.empty() ? "" : ", ", term.x(), term.y());
  }
  return "[" + out + "]";
}

/// Adds the fitted torsional stiffness, natural curvature and camera's tilt, as far as there are
/// any.
void add_shape_lines(std::string& out, const compare::MaterialFit& fit) {
  if (fit.torsional_stiffness && fit.torsional_stiffness->value) {
    append(out, "torsional_stiffness = {:.8e}  # N m^2, {}\n", *fit.torsional_stiffness->value,
           interval_text(*fit.torsional_stiffness));
  }
  if (!fit.natural_curvature.empty()) {
    append(out, "natural_curvature = {}\n", natural_curvature_text(fit));
  }
  if (!fit.camera_tilt.isZero(0)) {
    append(out, "camera_tilt = {}  # rad, of the shapes' coordinates\n",
           vector_text(fit.camera_tilt));
  }
}

/// Whether a rod is given by EI and mass per length, not by E and density.
/// @throws compare::InputError if it is given by one of each
bool is_given_by_stiffness(const compare::Scene& scene) {
  if (scene.given_bending_stiffness.has_value() == scene.given_mass_per_length.has_value()) {
    return scene.given_bending_stiffness.has_value();
  }
  throw compare::InputError(
      fmt::format("calibrate: no table can contain both {} and {} (allowed: a scene with both "
                  "bending_stiffness and "
                  "mass_per_length, or with neither; -o FILE.json)",
                  scene.stiffness().name, scene.mass_parameter().name));
}

void add_clamps(std::string& out, const compare::MaterialFit& fit) {
  for (const compare::ClampCorrection& correction : fit.clamps) {
    append(out, "[[gripper]]\nnumber = {}\nrotation = {}  # rad\ndisplacement = {}  # m\n",
           correction.gripper + 1, vector_text(correction.rotation),
           vector_text(correction.displacement));
  }
}

}  // namespace

void add_rod_lines(std::string& out, const compare::Scene& scene, const WrittenValue& stiffness,
                   const WrittenValue& mass_parameter, const std::string& source) {
  const bool given = is_given_by_stiffness(scene);
  if (!given) out += "[[material]]\nname = \"calibrated\"\n";
  std::string value = fmt::format("{:.8e}", stiffness.value);
  if (scene.given_bending_stiffness_2) {
    // A fit does not change the ratio of EI about d2 to EI about d1.
    const double ratio = *scene.given_bending_stiffness_2 / *scene.given_bending_stiffness;
    value = fmt::format("[{}, {:.8e}]", value, ratio * stiffness.value);
  }
  append(out, "{} = {}  # {}, {}\n", stiffness_key(scene).name, value, scene.stiffness().unit,
         stiffness.interval);
  append(out, "{} = {:.8e}  # {}, {}\n", mass_parameter_key(scene).name, mass_parameter.value,
         scene.mass_parameter().unit, mass_parameter.interval);
  append(out, "{}{}{}\n", given ? "# " : "source = \"", source, given ? "" : "\"");
}

std::string material_toml(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  const FittedValue& E = fit.youngs_modulus;
  const bool identified = E.value && (!fit.density || fit.density->value);
  // Values that are not identified may still predict shapes together.
  const bool predicts = fit.prediction && E.estimate && (!fit.density || fit.density->estimate);
  if (!identified && !predicts) {
    throw compare::InputError("calibrate: no material to write, " + fit.not_identified);
  }
  const compare::Scene& scene = report.scenes.front();
  std::string out =
      is_given_by_stiffness(scene)
          ? "# Written by dlo calibrate, for --calibrated, or lines of a scene's [rod].\n"
          : "# Written by dlo calibrate, for --calibrated, or --materials and material = "
            "\"calibrated\" in a scene.\n";
  if (!identified) {
    append(out,
           "# For shapes like these, of which one is predicted from the others to {:.4g} mm. No "
           "material: {}.\n",
           fit.prediction->rms_m * 1000, fit.not_identified);
  }
  add_shape_lines(out, fit);
  add_rod_lines(out, scene, {*E.estimate, interval_text(E)},
                fit.density ? WrittenValue{*fit.density->estimate, interval_text(*fit.density)}
                            : WrittenValue{scene.mass_parameter().value, "from the scene"},
                fmt::format("least squares of {} measured shape{}, noise {:.3g} m{}",
                            fit.shapes.size(), fit.shapes.size() == 1 ? "" : "s", fit.noise_m,
                            fit.correlation ? ", correlated along the rod" : ""));
  add_clamps(out, fit);
  return out;
}

}  // namespace dlo::cli
