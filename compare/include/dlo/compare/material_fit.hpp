#pragma once

#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// Young's modulus, one for all scenes, from a measured shape of each: least squares on the energy
/// model's shapes, over the modulus, each shape's frame and, where the file has no arc lengths, the
/// place of each point along its rod.
///
/// The points' coordinates are taken to have errors of the same standard deviation. With given arc
/// lengths a point counts three numbers, else the two across the rod, since the error along it does
/// not show; a shape that lies in a plane to rounding, as a flat picture's, one number less and as
/// many coordinates of its frame less.
///
/// The interval is that of the profile likelihood: all E at which the sum of squares, minimised
/// over everything else, is below S_min (1 + t^2 / nu) with Student's t of nu degrees of freedom
/// at 97.5 %; with a given noise, below S_min + (1.96 sigma)^2. It needs no linearisation and may
/// be open on a side. It reaches to every other local minimum in the joint region of all fitted
/// numbers, frames included, that is left with a chance of 1e-3 (F distribution; a given noise:
/// chi-squared), since a piece of a soft rod in an unknown frame also looks like
/// another piece of a stiffer one. Where it is open or wider than `identified_within`, E is not
/// identifiable from the shapes and no value is given.
///
/// Where the residuals show that errors along the rod are correlated (likelihood ratio against
/// white noise plus a first-order autoregression in arc length, restricted maximum likelihood), the
/// interval is that of least squares under such errors: t^2 S_min / nu is multiplied by the
/// variance of E over that of independent errors with the same sum of squares, and nu is
/// Satterthwaite's. The errors of the correlation itself are not in it: over a fifth of the rod it
/// still holds the truth less often than in 95 of 100.
///
/// Between several grippers, equilibria are followed from one E to the next.
///
/// With torsional stiffness, natural curvature, directions or positions to be fitted too, all
/// numbers are found together by Gauss-Newton steps from that E, in least squares; terms of natural
/// curvature are added one after the other, so that more of them never fit worse. What is known
/// before (the tolerances; of each term of natural curvature a standard deviation of 10 / l; of
/// GJ / EI, where the scene's is a guess, a factor of ten) counts as measured. Where errors are
/// correlated the numbers' covariance is that of least squares under such errors, in the mean over
/// all correlations that the residuals leave likely. The interval of E is where the profile of the
/// squares, in which the others' effect is linear about the optimum, has risen by as much as that
/// variance says; that of GJ is linear altogether. Where natural curvature is fitted, the
/// rod of a flat shape is confined to its scene's plane; the warning says if it would leave it.
///
/// Two shapes or more are asked whether they agree on E within their errors; where they do not, the
/// interval is that of their mean under a scatter between shapes (Paule and Mandel's estimate, with
/// Student's t of one degree of freedom less than there are shapes), if it is wider.
///
/// E and density are told apart only by forces that do not grow with density, such as loads: the
/// shape under gravity alone depends on density / E.
/// Where neither weight nor a load or yielding obstacle acts on the rod, its equilibria are the
/// same with every E, and E is not looked for; what else is asked for is found as with the scene's
/// E.
/// @throws InputError if scenes and shapes do not pair, or there are fewer numbers than unknowns;
/// ConvergenceError if the energy model has a shape at no modulus, if a shape within the interval
/// is not verified on its obstacles, or if `solve.time_limit` per scene is over
[[nodiscard]] MaterialFit fit_material(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options = {});

/// A shape that was not fitted, against the rod that was.
struct HeldOutShape {
  std::string file;   ///< its name
  std::string scene;  ///< that of its scene
  double rms_m = 0;   ///< distance of its points from the rod
};

/// Measured shapes of a rod and what they say of its material: what `dlo calibrate --shape` says,
/// and Python with it.
struct Calibration {
  std::vector<Scene> scenes;           ///< of each shape one
  std::vector<std::string> files;      ///< the shapes' names
  bool frame_was_found = false;        ///< what is unknown of the shapes' frames was fitted as well
  MaterialFit fit;                     ///< with its alternatives
  std::vector<HeldOutShape> held_out;  ///< in the order given
};

/// Shapes with equal points count once; MaterialFit::warning names them.
/// @param scenes    of each shape one, then of each that is held out, or one of them all; else as
///                  fit_material()
/// @param held_out  shapes that only judge
[[nodiscard]] Calibration calibrate(std::vector<Scene> scenes, std::vector<MeasuredShape> shapes,
                                    MaterialFitOptions options = {},
                                    const std::vector<MeasuredShape>& held_out = {});

}  // namespace dlo::compare
