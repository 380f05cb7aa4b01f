#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "least_squares/measured_shapes.hpp"

namespace dlo::compare {

/// A number of a wire, or of the way in which one shape of it was held, that is fitted to shapes.
struct WireNumber {
  /// Description of the number; its value is not used, and an infinite deviation means no prior.
  FittedNumber described;
  double difference_step =
      0;  ///< stride of differences, in the number's unit; 0: the number is not fitted
  std::function<void(Scene&, double)> change;
  int term = 0;  ///< index of the term of natural curvature; 0 for all other numbers
  double longest_step = std::numeric_limits<double>::infinity();  ///< longest step for which the
                                                                  ///< fit is nearly linear
  /// Whether it rotates the first clamp of a rod whose frame affects the shape, so that all angles
  /// must be tried.
  bool rotates_rod = false;
  std::optional<Eigen::Vector3d> camera_axis = std::nullopt;  ///< axis of a camera's tilt, unit
};

/// Returns the options with which the shapes of a fit are aligned with its rods. If natural
/// curvature is fitted, the rod of a planar shape is confined to its plane. A photograph has no
/// third coordinate: the fit would otherwise bend the rod out of the picture to reduce the
/// residuals in it.
[[nodiscard]] inline MeasuredOptions measured_options(const MaterialFitOptions& options) {
  return {
      .pose = options.pose,
      .arc_lengths = options.arc_lengths,
      .solve = options.solve,
      .flat = options.natural_curvature_terms > 0 ? FlatShapes::confined : FlatShapes::unmeasured};
}

/// Returns the error of the energy model [m]. With it as lower bound of the noise, the interval of
/// a perfect shape is not rounding.
[[nodiscard]] inline double least_noise(const Scene& scene) { return 1e-8 * scene.length; }

/// Returns why shapes cannot share the tilt of a camera, with file and allowed values; empty if
/// they can.
[[nodiscard]] std::string why_no_camera_tilt(const std::vector<Scene>& scenes,
                                             const std::vector<MeasuredShape>& shapes);

/// Returns the scenes with d1 stated explicitly at the first clamp if natural curvature and
/// directions or rolls are fitted, else unchanged. Scenes of flat shapes, without a clamp, or that
/// state d1 are unchanged too. A fit may rotate this clamp out of the scene's plane, which would
/// otherwise define d1. If the scene determines d1 only up to `roll_tolerance`, d1 is level.
/// @param measured  a shape of each scene; a flat one was measured in the scene's plane, which
/// determines d1
/// @throws InputError as Scene::first_frame(), without `roll_tolerance`
[[nodiscard]] std::vector<Scene> with_nominal_frames(std::vector<Scene> scenes,
                                                     const MeasuredShapes& measured,
                                                     const MaterialFitOptions& options);

/// Returns all numbers to fit, in this order: the logarithm of the factor on E; with `density` that
/// on the density; if requested that on GJ / EI, and natural curvature; then directions and
/// positions of grippers, shared or of each shape; each shape's differences from shared directions;
/// rolls of each shape; and the tilt of the camera.
/// @param scenes  result of with_nominal_frames()
/// @throws InputError if natural curvature is requested but given by a rest shape, or no clamp or
/// plane defines its axes, GJ but no scene twists the rod, shared clamps of scenes whose grippers
/// differ, rolls but no shape depends on one, or a tilt that why_no_camera_tilt() rejects
[[nodiscard]] std::vector<WireNumber> wire_numbers(const std::vector<Scene>& scenes,
                                                   const std::vector<MeasuredShape>& shapes,
                                                   const MaterialFitOptions& options, bool density);

}  // namespace dlo::compare
