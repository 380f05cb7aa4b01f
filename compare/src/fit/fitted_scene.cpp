#include "fit/fitted_scene.hpp"

#include <cmath>
#include <utility>

#include "dlo/compare/calibrated_rod.hpp"

namespace dlo::compare {

Scene fitted_scene(Scene scene, const MaterialFit& fit, const Scene& first) {
  CalibratedRod rod{.by_stiffness = scene.given_bending_stiffness.has_value(),
                    .natural_curvature = fit.natural_curvature,
                    .clamps = fit.clamps,
                    .camera_tilt = fit.camera_tilt};
  if (fit.youngs_modulus.estimate) {
    rod.stiffness =
        scene.stiffness().value * *fit.youngs_modulus.estimate / first.stiffness().value;
  }
  if (fit.density && fit.density->estimate) {
    rod.heaviness = scene.heaviness().value * *fit.density->estimate / first.heaviness().value;
  }
  if (fit.torsional_stiffness) rod.torsional_stiffness = fit.torsional_stiffness->estimate;
  return calibrated_scene(std::move(scene), rod);
}

MaterialPoint material_of(const MaterialFit& fit, const Scene& first) {
  MaterialPoint result;
  if (fit.youngs_modulus.estimate) {
    result.log_modulus = std::log(*fit.youngs_modulus.estimate / first.stiffness().value);
  }
  if (fit.density && fit.density->estimate) {
    result.log_density = std::log(*fit.density->estimate / first.heaviness().value);
  }
  return result;
}

}  // namespace dlo::compare
