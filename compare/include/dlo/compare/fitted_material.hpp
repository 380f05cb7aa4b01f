#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/calibrated_rod.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Options of a fit: the fitted quantities and the assumptions about the shapes.
struct MaterialFitOptions {
  PoseFreedom pose = PoseFreedom::known;  ///< unknown part of the shapes' frames
  /// `automatic` uses the file's arc lengths, else nearest points: chord lengths are not exact
  /// enough.
  ArcLengths arc_lengths = ArcLengths::automatic;
  bool density = false;  ///< whether the density is fitted as well
  /// Whether GJ is fitted as well, in scenes that twist the rod.
  bool torsional_stiffness = false;
  /// Number of terms of the natural curvature that are fitted as well, 0 to 24: coefficients of
  /// Legendre's P_0, P_1, .. of 2 s/l - 1, in a plane about its normal, else about d1 and d2.
  int natural_curvature_terms = 0;
  /// Standard deviation of the clamps' directions about each perpendicular axis [rad]. If > 0, the
  /// directions of each shape's clamps are fitted as well, in a planar scene within its plane.
  double direction_tolerance = 0;
  /// Standard deviation of the grippers' positions along each axis [m]. If > 0, the positions are
  /// fitted as well.
  double position_tolerance = 0;
  /// Standard deviation of the roll with which clamps hold the rod about its tangent [rad]. If > 0,
  /// the rolls of each shape are fitted as well, in space, for clamps that hold the rod's frame.
  /// The first clamp is excluded if the shape does not depend on the rod's own frame, because then
  /// only the twist between clamps is visible. With natural curvature the roll of the first clamp
  /// is also fitted in scenes that do not give its d1; at roll 0 that d1 is in the scene's plane,
  /// or level if there is no plane.
  double roll_tolerance = 0;
  /// Whether clamps are misaligned alike in all shapes, as in one fixture: one set of directions
  /// and positions is fitted for all shapes (MaterialFit::clamps). Else each shape has its own set.
  bool shared_clamps = false;
  /// With `shared_clamps`: standard deviation of the difference between a shape's own directions
  /// and the shared ones, about each perpendicular axis [rad]. If > 0, these differences are fitted
  /// as well.
  double direction_scatter = 0;
  /// Standard deviation of the camera's tilt about the normal of the shapes' plane, in space about
  /// each level axis [rad]. If > 0, one tilt of all shapes is fitted (MaterialFit::camera_tilt), in
  /// scenes where weight alone bends the rod.
  double camera_tilt = 0;
  /// Whether each shape in turn is predicted by the fit to the others (MaterialFit::prediction).
  bool predict = false;
  /// Whether terms of natural curvature and clamp misalignments, shared or of each shape, are
  /// chosen by cross-validation: those are fitted that best predict the shapes that are left out
  /// (MaterialFit::tried). Nothing is tried if the fit without them leaves nothing systematic. The
  /// options above then limit the number of terms (at least three are tried) and give the accuracy
  /// of the clamps. If they are 0, the accuracy is assumed: 20 degrees for shared clamps, with a
  /// scatter of 5 degrees and a camera that is level to 2 degrees; 5 degrees for clamps of each
  /// shape. The interval of E is extended to that of the largest number of terms that predicts
  /// nearly as well. At least three shapes are needed. Empty: calibrate() chooses so if there are
  /// three shapes or more and neither natural curvature nor errors of clamps are requested;
  /// fit_material() does not.
  std::optional<bool> choose_options;
  /// Whether, if residuals are systematic and none of the above is fitted, the fit tests which of
  /// them would remove the residuals (MaterialFit::alternatives). With one or two shapes, E's
  /// interval then includes that of an intrinsically curved wire in misaligned clamps.
  bool alternatives = false;
  /// Number of segments of a chain of hinges that is to be as stiff, 4 to 200; else no chain.
  int chain_segments = 0;
  /// 4 to 200 lengths of the segments of such a chain if they are unequal [m]; empty: no chain.
  std::vector<double> chain_segment_lengths = {};
  int profile_points = 0;  ///< number of points of MaterialFit::profile; 0: no profile
  /// Standard deviation of one coordinate [m]; empty: it is estimated.
  std::optional<double> noise;
  /// Smallest modulus that is searched, divided by that of the scene [-]. If natural curvature or
  /// clamp misalignments are fitted, the search ends at w l^3 / (EI) = 1e5, or at 100 times the
  /// scene's value if that is larger.
  double smallest_ratio = 1e-4;
  /// Largest modulus that is searched, divided by that of the scene [-].
  double largest_ratio = 1e4;
  /// A number counts as identified only if the ratio of its interval's ends is at most this factor.
  double largest_interval_ratio = 4;
  SolveOptions solve;  ///< limits of the solvers
};

/// A fitted quantity and its 95 % interval; an empty end of the interval is open as far as was
/// searched.
struct FittedValue {
  /// Given only if the interval is closed and no wider than
  /// MaterialFitOptions::largest_interval_ratio.
  std::optional<double> value;
  /// Best value, identified or not; the scene's value if E has no effect and is not searched.
  std::optional<double> estimate;
  std::optional<double> low;   ///< lower end of the interval
  std::optional<double> high;  ///< upper end of the interval
};

/// A number that was fitted in addition to E and the density.
struct FittedNumber {
  std::string name;            ///< "natural curvature about d2, P_1", "direction of gripper 2"
  std::string unit;            ///< SI: "1/m", "rad" or "m"
  double value = 0;            ///< correction of the scene's value; the most likely one
  double deviation = 0;        ///< standard deviation, prior knowledge included
  double prior_deviation = 0;  ///< prior standard deviation, without the shapes
  /// Index of the shape that it belongs to; empty: it belongs to the wire.
  std::optional<std::size_t> shape;

  /// Whether the shapes, rather than the prior, determine the number: the variance is at most half
  /// of the prior variance.
  [[nodiscard]] bool is_determined_by_shapes() const {
    return 2 * deviation * deviation <= prior_deviation * prior_deviation;
  }
};

/// Scatter of E between shapes. It is given if single shapes differ in E by more than their errors
/// explain, at a significance of 5 % (Cochran's Q): repeated mountings of a wire scatter.
struct ScatterBetweenShapes {
  double relative_deviation = 0;  ///< standard deviation of E between shapes, divided by E [-]
  double chance = 1;  ///< probability of differences as large as these without scatter [-]
  /// Width of the interval of E, divided by its width without scatter [-].
  double widening = 1;
};

/// Quantities that were not fitted, and the result of a fit that includes them.
struct FitAlternative {
  int natural_curvature_terms = 0;  ///< as in MaterialFitOptions
  double direction_tolerance = 0;   ///< as in MaterialFitOptions [rad]
  double rms_m = 0;                 ///< RMS distance between points and rod
  FittedValue youngs_modulus;       ///< as MaterialFit::youngs_modulus
  double position_tolerance = 0;    ///< as in MaterialFitOptions [m]
  bool shared_clamps = false;       ///< as in MaterialFitOptions
  double direction_scatter = 0;     ///< as in MaterialFitOptions [rad]
  double camera_tilt = 0;           ///< as in MaterialFitOptions [rad]
  /// Prediction::rms_m [m], if it was computed.
  std::optional<double> prediction_m = std::nullopt;
};

/// A joint of a chain of unequal segments.
struct ChainJoint {
  double at = 0;         ///< arc length [m]
  double stiffness = 0;  ///< moment divided by angle [N m/rad]
  /// Stiffness k of the joint with the energy of discrete elastic rods [N m/rad], as
  /// ChainSprings::binormal_stiffness.
  double binormal_stiffness = 0;
};

/// Springs with which a chain of hinges comes nearest to the fitted rod in a scene. Between unequal
/// segments each joint has its own stiffness, EI divided by the mean length of both segments, times
/// `stiffness_ratio`.
struct ChainSprings {
  std::string scene;                     ///< name of the scene
  ChainClamp clamp = ChainClamp::hinge;  ///< how clamps hold the chain
  /// Number of segments; those that clamps hold in the middle count as whole ones.
  int segments = 0;
  double segment_length = 0;  ///< h [m]; the mean if segments are unequal
  /// Moment of a joint between segments of that length, divided by its angle [N m/rad].
  double stiffness = 0;
  double stiffness_ratio = 1;  ///< `stiffness` divided by EI / h [-]
  double rms_m = 0;            ///< RMS distance of the chain's points from the rod
  /// Stiffness k of a joint between segments of that length with the energy of discrete elastic
  /// rods, k (2 tan(angle/2))^2 / 2 [N m/rad].
  double binormal_stiffness = 0;
  /// Unequal segment lengths, scaled to the rod's length [m]; empty: all are equal.
  std::vector<double> segment_lengths;
  std::vector<ChainJoint> joints;  ///< joints between unequal segments, along the rod; else empty
};

/// RMS distances between shapes and the rod that was fitted without them [m].
struct Prediction {
  std::vector<double> shapes_m;  ///< distance of each shape from the best fit to the others
  double rms_m = 0;              ///< RMS over all points
  /// RMS distance of each shape from the mean of the others, measured as from a rod: no rod could
  /// predict the shapes better. Empty if the rods' lengths or the grippers' arc lengths differ, if
  /// the grippers' positions differ by more than 2 % of the length or their directions by more than
  /// 0.02, or if less than half of the longest shape is common to all.
  std::optional<double> repeatability_m;

  /// Returns the prediction error divided by the repeatability [-]; empty if the latter is unknown
  /// or 0.
  [[nodiscard]] std::optional<double> repeatability_ratio() const {
    if (!repeatability_m || !(*repeatability_m > 0)) return std::nullopt;
    return rms_m / *repeatability_m;
  }
};

/// Ratio of prediction error to repeatability from which the output states that the fit predicts
/// worse than the shapes repeat. The ratio of two such estimates from five shapes scatters by a
/// tenth.
inline constexpr double reported_repeatability_ratio = 1.2;

/// Alignment of one shape with the fitted rod.
struct FittedShape {
  std::string scene;    ///< name of the scene
  Alignment alignment;  ///< alignment of the shape with the fitted rod
  Shape rod;  ///< the fitted rod at 201 equal arc lengths; empty unless there is a profile
};

/// A point of the profile likelihood.
struct ProfilePoint {
  double stiffness = 0;  ///< E or EI, as MaterialFit::youngs_modulus
  /// Increase of the sum of squares above that of the best fit, minimised over all other numbers,
  /// divided by the increase at the ends of the interval: 0 at the best fit, 1 at the ends [-].
  /// Infinite if the energy model has no shape.
  double excess_over_limit = 0;
};

/// Correlation of the errors of neighbouring points.
struct CorrelatedErrors {
  /// Correlation length: arc length over which the correlation decreases to 1 / e [m].
  double length_m = 0;
  double share = 0;  ///< correlated share of the errors' variance; the rest is independent [-]
  /// Width of the interval of E, divided by that for independent errors, to first order [-].
  double widening = 1;
  /// Effective degrees of freedom of the residuals: the number that independent ones would have.
  double degrees_of_freedom = 0;
};

/// Result of a fit of a material to measured shapes.
struct MaterialFit {
  /// E [Pa], or EI [N m^2] of a rod that is given by EI (Scene::stiffness of the first scene).
  FittedValue youngs_modulus;
  /// Density [kg/m^3], or mass per length [kg/m] of a rod that is given by it
  /// (Scene::mass_parameter); empty if it was not requested or could not be fitted.
  std::optional<FittedValue> density;
  /// GJ of the first scene [N m^2], if it was requested.
  std::optional<FittedValue> torsional_stiffness;
  /// GJ / EI of the first scene [-], if GJ was requested; EI is the mean of EI about d1 and d2. The
  /// ratio may be identifiable where weight is too small to identify either.
  std::optional<FittedValue> torsion_over_bending;
  /// Quantities that are not identifiable from the shapes, and why; empty if all are identified.
  std::string not_identified;
  /// Given quantities whose errors may leave no residual, such as "length", "weight", "natural
  /// curvature": the interval of E holds only if they are right. fit_material() lists only natural
  /// curvature and clamp directions, calibrate() all; the latter lists none without an interval.
  std::vector<std::string> assumed;
  /// Reasons to distrust the fit: residuals far above the given noise (probability 1e-3, or 5 % if
  /// more than E and density is fitted) or above a twentieth of the length, systematic residuals, a
  /// contradicted tolerance, a rod that would leave its plane, or, by calibrate(), repeated shapes.
  std::string warning;
  /// Standard deviation of one coordinate: given, or estimated and then at least 1e-8 l, the energy
  /// model's own error.
  double noise_m = 0;
  /// Whether the residuals were tested for correlation: they have at least 5 degrees of freedom and
  /// are above the energy model's own error.
  bool correlation_was_tested = false;
  /// Given if independent errors would look as correlated with a probability below 5 %.
  std::optional<CorrelatedErrors> correlation;
  /// Share of the residuals' mean square, perpendicular to the rod, that all shapes have in common
  /// at equal arc length; for independent residuals 1 divided by the number of shapes. Empty for a
  /// single shape, without a plane, if less than half of the longest shape is common to all, if
  /// only the model's own error is left, if more than E and density is fitted, or without
  /// `alternatives`.
  std::optional<double> common_share;
  /// Alternatives for systematic residuals (correlated along the rod, or common to all shapes):
  /// quantities whose fit would leave at most 0.7 of the residuals, the smallest residual first.
  /// One that includes the quantities of another is listed only if it leaves clearly less. The
  /// interval of E holds only if there is no other error.
  std::vector<FitAlternative> alternatives;
  /// With `choose_options`: the options that were tried, the chosen one first. It has the fewest
  /// numbers among those that predict as well as the best (within 1 %). The interval of E is
  /// extended to that of the largest number of terms that predicts nearly as well (within 10 %). If
  /// nothing systematic was left, it is the only one, with a prediction only if one was requested.
  std::vector<FitAlternative> tried;
  /// Numbers that were requested: natural curvature, directions and positions of grippers,
  /// differences from shared directions, rolls, and the tilt of the camera.
  std::vector<FittedNumber> others;
  /// Natural curvature of the first scene with the fitted corrections, about d1 and d2 [1/m]:
  /// coefficients of P_0, P_1, .. in this order; empty if it was not requested.
  std::vector<Eigen::Vector2d> natural_curvature;
  std::vector<ClampCorrection> clamps;  ///< clamp corrections, with `shared_clamps`
  Eigen::Vector3d camera_tilt = Eigen::Vector3d::Zero();  ///< as in CalibratedRod [rad]
  std::optional<Prediction> prediction;                   ///< if it was requested
  std::optional<ScatterBetweenShapes> scatter;            ///< if there is a significant one
  /// Chains with the requested segments, one for each different scene and each ChainClamp that is
  /// possible there. Empty if E is not identified, or if the scene has what a plain chain lacks
  /// (sections, natural curvature, two bending stiffnesses, couples, a gripper between its joints).
  std::vector<ChainSprings> chains;
  bool noise_is_estimated = true;   ///< whether the noise was estimated, not given
  int degrees_of_freedom = 0;       ///< number of measured numbers minus number of fitted numbers
  double rms_m = 0;                 ///< RMS distance between points and rod at the best fit
  long equilibria = 0;              ///< number of equilibria that the energy model solved
  long evaluations = 0;             ///< evaluations of the energy model's objective for them
  std::vector<FittedShape> shapes;  ///< in the order given
  /// Profile of E, from half the interval's width below the interval to as far above, equally
  /// spaced in log E. An open end counts as a factor of two from the best fit.
  std::vector<ProfilePoint> profile;
};

}  // namespace dlo::compare
