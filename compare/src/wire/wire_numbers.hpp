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

/// A number of a wire, or of how one shape of it was held, that is fitted to shapes.
struct WireNumber {
  /// Its value is not in use; nothing known before is an infinite deviation.
  FittedNumber described;
  double stride = 0;  ///< of differences, in its unit; 0: it is in no shape
  std::function<void(Scene&, double)> change;
  int term = 0;  ///< of natural curvature; 0 of all other numbers
  double longest_step = std::numeric_limits<double>::infinity();  ///< beyond it nothing is linear
  /// How the first clamp holds a rod whose own frame shows: all angles are to be tried.
  bool turns_the_rod = false;
  std::optional<Eigen::Vector3d> camera_axis = std::nullopt;  ///< of a camera's tilt, unit
};

/// How the shapes of a fit lie on its rods. A photograph does not see the third coordinate: a fit
/// of natural curvature would bend the rod out of the picture to come nearer in it, so it is
/// confined.
[[nodiscard]] inline MeasuredOptions measured_options(const MaterialFitOptions& options) {
  return {
      .pose = options.pose,
      .arc_lengths = options.arc_lengths,
      .solve = options.solve,
      .flat = options.natural_curvature_terms > 0 ? FlatShapes::confined : FlatShapes::unmeasured};
}

/// Why shapes do not have a camera's tilt in common, naming file and what is allowed; empty: they
/// may.
[[nodiscard]] std::string why_no_camera_tilt(const std::vector<Scene>& scenes,
                                             const std::vector<MeasuredShape>& shapes);

/// Scenes in which the first clamp says where d1 is, so that it goes on holding it when it is
/// turned out of the scene's plane: where the scene leaves it open but for `roll_tolerance`, d1 is
/// level.
/// @param flat  whose shape was measured in the scene's plane, which says where d1 is
[[nodiscard]] std::vector<Scene> with_said_frames(std::vector<Scene> scenes,
                                                  const std::vector<bool>& flat,
                                                  const MaterialFitOptions& options);

/// All that is to be found: first the logarithm of E over the scenes', then, with `density`, of the
/// density, if asked for of GJ / EI, natural curvature, then each shape's own directions and
/// positions and rolls, and the camera's tilt.
/// @param scenes  with_said_frames()
/// @throws InputError if natural curvature is asked for where no clamp or plane says about which
/// axes, GJ where no scene twists the rod, rolls where none is in a shape, or a tilt where
/// why_no_camera_tilt()
[[nodiscard]] std::vector<WireNumber> wire_numbers(const std::vector<Scene>& scenes,
                                                   const std::vector<MeasuredShape>& shapes,
                                                   const MaterialFitOptions& options, bool density);

}  // namespace dlo::compare
