#include "dlo/compare/calibrated_rod.hpp"

#include <fmt/format.h>

#include <limits>

#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "least_squares/scene_change.hpp"
#include "toml/strict_table.hpp"

namespace dlo::compare {
namespace {

constexpr std::size_t most_terms = 25;
constexpr int most_corrected = 1000;

/// Reads the material that calibrate writes for a rod given by E.
void read_calibrated_material(StrictTable& table, CalibratedRod& rod) {
  for (StrictTable& entry : table.tables("material")) {
    entry.only({"density", "name", "source", "youngs_modulus"});
    (void)entry.text("name");
    (void)entry.optional_text("source");
    rod.stiffness = entry.number("youngs_modulus", Dimension::pressure, Range::positive());
    rod.mass_parameter = entry.number("density", Dimension::density, Range::positive());
    entry.finish();
  }
}

/// Reads the lines of [rod] that calibrate writes for a rod given by EI.
void read_calibrated_stiffness(StrictTable& table, CalibratedRod& rod) {
  const auto pairs = table.pairs("bending_stiffness", Dimension::section_stiffness, 1);
  if (pairs.empty()) return;
  const Eigen::Vector2d& EI = pairs.front();
  rod.by_stiffness = true;
  // Two stiffnesses are scaled by one factor, so the first one determines it.
  rod.stiffness = EI.x() > 0 ? EI.x() : EI.y();
  if (!(*rod.stiffness > 0)) table.fail("bending_stiffness", "not positive (allowed: > 0)");
  rod.mass_parameter =
      table.number("mass_per_length", Dimension::mass_per_length, Range::positive());
}

ClampCorrection read_correction(StrictTable& entry) {
  entry.only({"displacement", "number", "rotation"});
  ClampCorrection correction;
  correction.gripper = static_cast<std::size_t>(entry.integer("number", 1, most_corrected) - 1);
  correction.rotation =
      entry.optional_vector("rotation", Dimension::angle).value_or(correction.rotation);
  correction.displacement =
      entry.optional_vector("displacement", Dimension::length).value_or(correction.displacement);
  entry.finish();
  return correction;
}

}  // namespace

CalibratedRod parse_calibrated_rod(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  StrictTable table(root, "", file);
  table.only({"bending_stiffness", "camera_tilt", "damping", "drag", "gripper", "mass_per_length",
              "material", "natural_curvature", "quadratic_drag", "torsional_stiffness"});
  CalibratedRod rod;
  read_calibrated_material(table, rod);
  read_calibrated_stiffness(table, rod);
  if (!rod.stiffness) {
    throw InputError(fmt::format(
        "{}: neither a [[material]] nor bending_stiffness (allowed: what dlo calibrate -o writes)",
        file));
  }
  rod.torsional_stiffness =
      table.optional_number("torsional_stiffness", Dimension::section_stiffness, Range::positive());
  if (table.has("natural_curvature")) {
    rod.natural_curvature = table.pairs("natural_curvature", Dimension::curvature, most_terms);
  }
  const auto damping = [&table](const char* key, Dimension dimension) {
    return table.optional_number(key, dimension, Range::not_negative());
  };
  rod.damping = damping("damping", Dimension::time);
  rod.drag = damping("drag", Dimension::number);
  rod.quadratic_drag = damping("quadratic_drag", Dimension::number);
  rod.camera_tilt =
      table.optional_vector("camera_tilt", Dimension::angle).value_or(rod.camera_tilt);
  for (StrictTable& entry : table.tables("gripper")) rod.clamps.push_back(read_correction(entry));
  table.finish();
  return rod;
}

CalibratedRod load_calibrated_rod(const std::string& path) {
  return parse_calibrated_rod(read_file(path), path);
}

Scene calibrated_scene(Scene scene, const CalibratedRod& rod) {
  const NamedValue stiffness = scene.stiffness();
  if (rod.stiffness) {
    if (rod.by_stiffness != scene.given_bending_stiffness.has_value()) {
      throw InputError(
          fmt::format("{}: the rod is given by {}, the calibrated one by {} (allowed: both alike)",
                      scene.file, stiffness.name, rod.by_stiffness ? "EI" : "E"));
    }
    scene.scale_modulus(*rod.stiffness / stiffness.value);
  }
  if (rod.mass_parameter) scene.scale_density(*rod.mass_parameter / scene.mass_parameter().value);
  if (rod.torsional_stiffness) {
    scene.scale_torsion(*rod.torsional_stiffness / scene.twisting_stiffness());
  }
  if (!rod.natural_curvature.empty()) {
    scene.natural_strain.head<2>() = rod.natural_curvature.front();
    scene.natural_variation.assign(rod.natural_curvature.begin() + 1, rod.natural_curvature.end());
  }
  for (const ClampCorrection& correction : rod.clamps) {
    if (correction.gripper >= scene.grippers.size()) {
      throw InputError(
          fmt::format("{}: gripper {} is corrected (allowed: 1 to {}, as many as the "
                      "scene has)",
                      scene.file, correction.gripper + 1, scene.grippers.size()));
    }
    Gripper& gripper = scene.grippers[correction.gripper];
    if (gripper.direction) rotate_clamp(gripper, correction.rotation);
    gripper.position += correction.displacement;
  }
  if (rod.camera_tilt.isZero(0)) return scene;
  if (!is_bent_by_weight_alone(scene)) {
    throw InputError(fmt::format(
        "{}: the calibrated rod was observed by a tilted camera, camera_tilt, which applies only "
        "to scenes whose rod is bent by weight alone (allowed: such scenes, or no camera_tilt)",
        scene.file));
  }
  rotate_scene(scene, rod.camera_tilt);
  return scene;
}

}  // namespace dlo::compare
