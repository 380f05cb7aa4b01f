#include "fit/fit_from.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/error.hpp"
#include "fit/chain_springs.hpp"
#include "fit/material_alone.hpp"
#include "fit/material_profiles.hpp"
#include "wire/leave_one_out.hpp"
#include "wire/wire_fit.hpp"

namespace dlo::compare {
namespace {

/// Adds the chains of each scene; equal scenes are used once.
void add_chains(const std::vector<Scene>& scenes, const MaterialFitOptions& options,
                MaterialFit& fit) {
  for (auto scene = scenes.begin(); scene != scenes.end(); ++scene) {
    if (std::find(scenes.begin(), scene, *scene) != scene) continue;
    const Scene fitted = fitted_scene(*scene, fit, scenes.front());
    const std::vector<double>& lengths = options.chain_segment_lengths;
    for (ChainSprings& chain : lengths.empty()
                                   ? chain_springs(fitted, options.chain_segments, options.solve)
                                   : chain_springs(fitted, lengths, options.solve)) {
      fit.chains.push_back(std::move(chain));
    }
  }
}

/// Throws if a force acts on the scenes, E is not identified and solves ended at their evaluation
/// limit: without the limit it may be identifiable.
/// @throws ConvergenceError
void refuse_limited(MaterialProfiles& material, const MaterialFit& fit) {
  const long limited = material.measured().limited_solves();
  if (limited == 0 || fit.youngs_modulus.value || !material.is_forced()) return;
  const Scene& scene = material.scenes().front();
  throw ConvergenceError(fmt::format(
      "{}: {} of {} equilibria ended at the evaluation limit and {} is not identified from the "
      "others (--max-evaluations: more than {})",
      scene.file, limited, material.measured().solves(), scene.stiffness().name,
      material.options().solve.max_evaluations));
}

/// Fits all numbers of a wire. @param least  sum of squares at the start [m^2]
MaterialFit whole_wire(MaterialProfiles& material, const MaterialPoint& start, double least) {
  MaterialFit fit = fit_wire(material.scenes(), material.shapes(), material.measured(),
                             material.options(), start, material.has_density());
  fit.assumed = unfitted_assumptions(material.scenes(), material.options());
  material.refuse_unverified(least);
  if (fit.warning.empty()) {
    fit.warning = warning_of(material, fit.rms_m * fit.rms_m * material.points(), std::nullopt);
  }
  return fit;
}

/// Predicts each shape by a new fit to all others, which searches all E, and returns the distances.
/// @param fit  fit to all shapes, which determines the arc lengths of their points
/// @throws in the cases of fit_material()
Prediction predict_each(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                        const MaterialFitOptions& options, const MaterialFit& fit) {
  MaterialFitOptions same = options;
  same.alternatives = same.predict = false;
  same.chain_segments = same.profile_points = 0;
  same.chain_segment_lengths.clear();
  return leave_one_out(scenes, shapes, options, fit, [&](std::size_t left) -> PredictedScene {
    const std::vector<Scene> other_scenes = all_but(scenes, left);
    const MaterialFit others = fit_from(other_scenes, all_but(shapes, left), same, std::nullopt);
    return {fitted_scene(scenes[left], others, other_scenes.front()), std::nullopt};
  });
}

}  // namespace

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

MaterialFit fit_from(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                     const MaterialFitOptions& options, const std::optional<MaterialPoint>& start) {
  MaterialProfiles material(scenes, shapes, options);
  MaterialFit fit;
  if (start) {
    fit = whole_wire(material, *start, material.squares(*start));
  } else {
    const MaterialProfiles::Search found = material.search();
    fit = fits_a_wire(options)
              ? whole_wire(material, found.best, found.over_modulus.minimum().value)
              : fit_material_alone(material, found);
  }
  refuse_limited(material, fit);
  fit.equilibria = material.measured().solves();
  fit.evaluations = material.measured().evaluations();
  if (options.predict && !fit.prediction) {
    fit.prediction = predict_each(scenes, shapes, options, fit);
  }
  const bool of_chains = options.chain_segments > 0 || !options.chain_segment_lengths.empty();
  if (of_chains && fit.youngs_modulus.value) add_chains(scenes, options, fit);
  return fit;
}

}  // namespace dlo::compare
