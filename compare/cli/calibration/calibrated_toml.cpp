#include "calibration/calibrated_toml.hpp"

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
  const compare::NamedValue stiffness = scene.stiffness();
  const compare::NamedValue heaviness = scene.heaviness();
  if (scene.given_bending_stiffness.has_value() != scene.given_mass_per_length.has_value()) {
    throw compare::InputError(
        fmt::format("calibrate: {} and {} are of no one table (allowed: a scene with both "
                    "bending_stiffness and "
                    "mass_per_length, or with neither; -o FILE.json)",
                    stiffness.name, heaviness.name));
  }
  const double density = fit.density ? *fit.density->estimate : heaviness.value;
  const bool given = scene.given_bending_stiffness.has_value();
  std::string out =
      given ? "# Written by dlo calibrate, for --calibrated, or lines of a scene's [rod].\n"
            : "# Written by dlo calibrate, for --calibrated, or --materials and material = "
              "\"calibrated\" in a scene.\n";
  if (!identified) {
    append(out,
           "# For shapes like these, of which one is predicted from the others to {:.4g} mm. No "
           "material: {}.\n",
           fit.prediction->rms_m * 1000, fit.not_identified);
  }
  add_shape_lines(out, fit);
  if (!given) out += "[[material]]\nname = \"calibrated\"\n";
  std::string value = fmt::format("{:.8e}", *E.estimate);
  if (scene.given_bending_stiffness_2) {
    // A fit leaves the ratio of the two as it is.
    const double ratio = *scene.given_bending_stiffness_2 / *scene.given_bending_stiffness;
    value = fmt::format("[{}, {:.8e}]", value, ratio * *E.estimate);
  }
  append(out, "{} = {}  # {}, {}\n", stiffness_key(scene).name, value, stiffness.unit,
         interval_text(E));
  append(out, "{} = {:.8e}  # {}, {}\n", heaviness_key(scene).name, density, heaviness.unit,
         fit.density ? interval_text(*fit.density) : std::string("of the scene"));
  append(out, "{}least squares of {} measured shape{}, noise {:.3g} m{}{}\n",
         given ? "# " : "source = \"", fit.shapes.size(), fit.shapes.size() == 1 ? "" : "s",
         fit.noise_m, fit.correlation ? ", correlated along the rod" : "", given ? "" : "\"");
  add_clamps(out, fit);
  return out;
}

}  // namespace dlo::cli
