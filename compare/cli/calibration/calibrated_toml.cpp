#include "calibration/calibrated_toml.hpp"

#include <optional>

#include "base/quote.hpp"
#include "calibration/fitted_values.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::cli {
namespace {

using compare::append;
using compare::FittedValue;

/// As a scene file has it.
std::string vector_text(const Eigen::Vector3d& v) {
  return compare::formatted("[{:.6e}, {:.6e}, {:.6e}]", v.x(), v.y(), v.z());
}

/// As a scene file has it [1/m].
std::string natural_curvature_text(const compare::MaterialFit& fit) {
  std::string out;
  for (const Eigen::Vector2d& term : fit.natural_curvature) {
    append(out, "{}[{:.6e}, {:.6e}]", out.empty() ? "" : ", ", term.x(), term.y());
  }
  return "[" + out + "]";
}

/// What the fit says of the rod beside its material, and of the camera.
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
      fmt::format("calibrate: {} and {} are of no one table (allowed: a scene with both "
                  "bending_stiffness and "
                  "mass_per_length, or with neither; -o FILE.json)",
                  scene.stiffness().name, scene.heaviness().name));
}

/// Value with the comment that states its interval.
struct WrittenValue {
  double value = 0;
  std::string interval;
};

/// Adds stiffness, mass and the source of both: lines of [rod], or a [[material]].
void add_rod_lines(std::string& out, const compare::Scene& scene, const WrittenValue& stiffness,
                   const WrittenValue& heaviness, const std::string& source) {
  const bool given = is_given_by_stiffness(scene);
  if (!given) out += "[[material]]\nname = \"calibrated\"\n";
  std::string value = fmt::format("{:.8e}", stiffness.value);
  if (scene.given_bending_stiffness_2) {
    // A fit leaves the ratio of the two as it is.
    const double ratio = *scene.given_bending_stiffness_2 / *scene.given_bending_stiffness;
    value = fmt::format("[{}, {:.8e}]", value, ratio * stiffness.value);
  }
  append(out, "{} = {}  # {}, {}\n", stiffness_key(scene).name, value, scene.stiffness().unit,
         stiffness.interval);
  append(out, "{} = {:.8e}  # {}, {}\n", heaviness_key(scene).name, heaviness.value,
         scene.heaviness().unit, heaviness.interval);
  append(out, "{}{}{}\n", given ? "# " : "source = \"", source, given ? "" : "\"");
}

void add_clamps(std::string& out, const compare::MaterialFit& fit) {
  for (const compare::ClampCorrection& correction : fit.clamps) {
    append(out, "[[gripper]]\nnumber = {}\nrotation = {}  # rad\ndisplacement = {}  # m\n",
           correction.gripper + 1, vector_text(correction.rotation),
           vector_text(correction.displacement));
  }
}

}  // namespace

std::string material_toml(const compare::Calibration& report) {
  const compare::MaterialFit& fit = report.fit;
  const FittedValue& E = fit.youngs_modulus;
  const bool identified = E.value && (!fit.density || fit.density->value);
  // Numbers that are no material may still predict shapes, all together.
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
                            : WrittenValue{scene.heaviness().value, "of the scene"},
                fmt::format("least squares of {} measured shape{}, noise {:.3g} m{}",
                            fit.shapes.size(), fit.shapes.size() == 1 ? "" : "s", fit.noise_m,
                            fit.correlation ? ", correlated along the rod" : ""));
  add_clamps(out, fit);
  return out;
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
      {scene.heaviness().value, "of the scene"},
      fmt::format("least squares of {} recorded motion{}, noise {:.3g} m", fit.recordings.size(),
                  fit.recordings.size() == 1 ? "" : "s", fit.noise));
  return out;
}

}  // namespace dlo::cli
