#include "fit/fitted_scene.hpp"

#include "least_squares/scene_change.hpp"

namespace dlo::compare {

Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first) {
  if (fit.youngs_modulus.estimate) {
    scene.scale_modulus(*fit.youngs_modulus.estimate / first.stiffness().value);
  }
  if (fit.density && fit.density->estimate) {
    scene.scale_density(*fit.density->estimate / first.heaviness().value);
  }
  if (fit.torsional_stiffness && fit.torsional_stiffness->estimate) {
    scene.scale_torsion(*fit.torsional_stiffness->estimate / scene.twisting_stiffness());
  }
  if (!fit.natural_curvature.empty()) {
    scene.natural_strain.head<2>() = fit.natural_curvature.front();
    scene.natural_variation.assign(fit.natural_curvature.begin() + 1, fit.natural_curvature.end());
  }
  for (const ClampCorrection& correction : fit.clamps) {
    Gripper& gripper = scene.grippers[correction.gripper];
    if (gripper.direction) turn_clamp(gripper, correction.rotation);
    gripper.position += correction.displacement;
  }
  return scene;
}

}  // namespace dlo::compare
