#pragma once

#include <string>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"

namespace dlo::compare {

/// Fits Young's modulus, one for all scenes, to a measured shape of each scene: least squares on
/// the energy model's shapes, over the modulus, each shape's frame and, if the file has no arc
/// lengths, the arc length of each point.
///
/// The points' coordinates are assumed to have errors of the same standard deviation. With given
/// arc lengths a point counts as three numbers; else as the two perpendicular to the rod, because
/// the error along the rod is not visible. For a shape that lies in a plane to rounding, such as
/// one from an image, each point counts as one number less, and the coordinates of its frame out of
/// the plane are not counted.
///
/// The interval is that of the profile likelihood: all E at which the sum of squares, minimised
/// over all other unknowns, is below S_min (1 + t^2 / nu) with Student's t of nu degrees of freedom
/// at 97.5 %; with a given noise, below S_min + (1.96 sigma)^2. It needs no linearisation and may
/// be open at one end. It includes every other local minimum in the joint confidence region of all
/// fitted numbers, frames included, at the level 1 - 1e-3 (F distribution; with a given noise: chi-
/// squared), since a part of a soft rod in an unknown frame also looks like another part of a
/// stiffer one. If the interval is open or wider than `largest_interval_ratio`, E is not
/// identifiable from the shapes and no value is given.
///
/// If the residuals show that errors along the rod are correlated (likelihood ratio against white
/// noise plus a first-order autoregression in arc length, restricted maximum likelihood), the
/// interval is that of least squares under such errors: t^2 S_min / nu is multiplied by the
/// variance of E divided by that of independent errors with the same sum of squares, and nu is
/// Satterthwaite's. The uncertainty of the correlation itself is not included: if the errors are
/// correlated over a fifth of the rod, the interval still contains the truth in less than 95 of 100
/// cases.
///
/// Between several grippers, equilibria are followed from one value of E to the next.
///
/// If torsional stiffness, natural curvature, directions or positions are fitted too, all numbers
/// are found together by Gauss-Newton steps from that E, in least squares. Terms of natural
/// curvature are added one after the other, so that more of them never fit worse. Prior knowledge
/// counts as measurements: the tolerances; a standard deviation of 10 / l for each term of natural
/// curvature; a factor of ten for GJ / EI. If errors are correlated, the covariance of the numbers
/// is that of least squares under such errors, averaged over all correlations that the residuals
/// leave likely. The ends of the interval of E are where the profile of the squares, in which the
/// effect of the others is linear about the optimum, has increased by as much as that variance
/// implies; the interval of GJ is linear altogether. If natural curvature is fitted, the rod of a
/// planar shape is confined to its scene's plane; the warning states whether it would leave it.
///
/// Two or more shapes are tested for agreement on E within their errors. If they disagree, the
/// interval is that of their mean under a scatter between shapes (Paule and Mandel's estimate, with
/// Student's t of one degree of freedom less than there are shapes), if that is wider.
///
/// E and density can be distinguished only by forces that do not grow with density, such as loads:
/// the shape under gravity alone depends on density / E. If neither weight nor a load or compliant
/// obstacle acts on the rod, its equilibria are the same for every E, and E is not searched; the
/// other requested quantities are fitted with the scene's E.
/// @throws InputError if the numbers of scenes and shapes differ, if options contradict each other,
/// or if there are fewer numbers than unknowns; ConvergenceError if the energy model has no shape
/// at any modulus, if a shape within the interval is not verified on its obstacles, if solves ended
/// at their evaluation limit and E is not identified, or if `solve.time_limit` per scene is
/// exceeded
[[nodiscard]] MaterialFit fit_material(const std::vector<Scene>& scenes,
                                       const std::vector<MeasuredShape>& shapes,
                                       const MaterialFitOptions& options = {});

/// Comparison of a hold-out shape, which was not fitted, with the fitted rod.
struct HeldOutShape {
  std::string file;   ///< name of its file
  std::string scene;  ///< name of its scene
  double rms_m = 0;   ///< RMS distance of its points from the rod
};

/// Measured shapes of a rod and the fit of its material: the result of `dlo calibrate --shape`,
/// also in Python.
struct Calibration {
  std::vector<Scene> scenes;           ///< the scene of each shape
  std::vector<std::string> files;      ///< names of the shapes
  MaterialFit fit;                     ///< result of the fit, with its alternatives
  std::vector<HeldOutShape> held_out;  ///< hold-out shapes in the order given
};

/// Fits the material to the shapes and compares it with hold-out shapes. Shapes with equal points
/// count once; MaterialFit::warning names them.
/// @param scenes    one of each shape, then one of each hold-out shape, or a single one for all;
/// else as in fit_material()
/// @param held_out  shapes that are compared, but not fitted
/// @throws InputError if the numbers of scenes and shapes differ; otherwise as fit_material()
[[nodiscard]] Calibration calibrate(std::vector<Scene> scenes, std::vector<MeasuredShape> shapes,
                                    MaterialFitOptions options = {},
                                    const std::vector<MeasuredShape>& held_out = {});

}  // namespace dlo::compare
