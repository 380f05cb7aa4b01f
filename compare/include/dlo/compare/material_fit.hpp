#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// What is fitted, and from what.
struct MaterialFitOptions {
  PoseFreedom pose = PoseFreedom::known;  ///< what is unknown of the shapes' frames
  /// `automatic` is the file's own, else nearest points: chord lengths are not exact enough.
  ArcLengths arc_lengths = ArcLengths::automatic;
  bool density = false;          ///< fitted as well
  std::optional<double> noise;   ///< standard deviation of one coordinate [m]; else estimated
  double smallest_ratio = 1e-4;  ///< of the modulus to the scene's, where it is looked for
  double largest_ratio = 1e4;    ///< the upper end of that range
  SolveOptions solve;            ///< limits of the solvers
};

/// A fitted quantity and its 95 % interval; a side without a number is open as far as was searched.
struct FittedValue {
  std::optional<double> value;  ///< only if the interval is closed
  std::optional<double> low;    ///< lower end of the interval
  std::optional<double> high;   ///< upper end of the interval
};

/// How one shape was laid on the rod of the fitted modulus.
struct FittedShape {
  std::string scene;    ///< its name
  Alignment alignment;  ///< of the shape on the fitted rod
};

/// A material that fits measured shapes.
struct MaterialFit {
  FittedValue youngs_modulus;          ///< [Pa]
  std::optional<FittedValue> density;  ///< [kg/m^3], if it was asked for and could be fitted
  /// What the shapes do not tell, and why; empty if all is told.
  std::string not_told;
  /// Why the fit is not to be believed: residuals far above the given noise (chance 1e-3), or above
  /// a twentieth of the length; else empty.
  std::string warning;
  /// Standard deviation of one coordinate, given, or estimated and then no less than 1e-8 l, the
  /// energy model's own error.
  double noise_m = 0;
  bool noise_is_estimated = true;   ///< else it was given
  int degrees_of_freedom = 0;       ///< numbers measured less numbers fitted
  double rms_m = 0;                 ///< of the distances between points and rod at the fit
  std::vector<FittedShape> shapes;  ///< in the order given
};

/// Young's modulus, one for all scenes, from a measured shape of each: least squares on the energy
/// model's shapes, over the modulus, each shape's frame and, where the file has no arc lengths, the
/// place of each point along its rod.
///
/// The points' coordinates are taken to have independent errors of the same standard deviation.
/// With given arc lengths a point counts three numbers, else the two across the rod, since the
/// error along it does not show; a shape that lies in a plane to rounding, as a flat picture's, one
/// number less and as many coordinates of its frame less.
///
/// The interval is that of the profile likelihood: all E at which the sum of squares, minimised
/// over everything else, is below S_min (1 + t^2 / nu) with Student's t of nu degrees of freedom
/// at 97.5 %; with a given noise, below S_min + (1.96 sigma)^2. It needs no linearisation and may
/// be open on a side; then the shapes do not tell E and no value is given.
///
/// E and density are told apart only by forces that do not grow with density, such as loads: the
/// shape under gravity alone depends on density / E.
/// @throws InputError if scenes and shapes do not pair, or there are fewer numbers than unknowns;
/// ConvergenceError if the energy model has a shape at no modulus
[[nodiscard]] MaterialFit fit_material(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options = {});

}  // namespace dlo::compare
