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

/// What is fitted, and from what.
struct MaterialFitOptions {
  PoseFreedom pose = PoseFreedom::known;  ///< what is unknown of the shapes' frames
  /// `automatic` is the file's own, else nearest points: chord lengths are not exact enough.
  ArcLengths arc_lengths = ArcLengths::automatic;
  bool density = false;  ///< fitted as well
  /// GJ is fitted as well, of scenes that twist the rod.
  bool torsional_stiffness = false;
  /// Terms of the natural curvature that are fitted as well, as Legendre's P_0, P_1, .. of
  /// 2 s/l - 1: 0 to 24. In a plane about its normal, else about d1 and d2.
  int natural_curvature_terms = 0;
  /// How well the clamps' directions are known: standard deviation about each axis across [rad]. If
  /// it is > 0 each shape's own are fitted; in the plane of a planar scene.
  double direction_tolerance = 0;
  /// The same of the grippers' positions along each axis [m].
  double position_tolerance = 0;
  /// How well it is known how clamps hold the rod about its tangent: standard deviation [rad]. If
  /// it is > 0 each shape's own rolls are fitted, in space: of clamps that hold the rod's frame,
  /// but for the first one of a rod whose own frame is in no shape, where only the twist between
  /// clamps is; and with natural curvature also of the first clamp of scenes that do not say its
  /// d1. It is then in the scene's plane at roll 0, and level where there is none.
  double roll_tolerance = 0;
  /// Clamps are misaligned alike in all shapes, as in one fixture: the numbers of their directions
  /// and positions are shared (MaterialFit::clamps). Else each shape has its own.
  bool shared_clamps = false;
  /// With `shared_clamps`: how far each shape's own directions are from the shared ones: standard
  /// deviation about each axis across [rad]. If it is > 0 they are fitted as well.
  double direction_scatter = 0;
  /// How level the camera is: standard deviation of its tilt about the normal of the shapes' plane,
  /// in space about each level axis [rad]. If it is > 0 one tilt of all shapes is fitted, of scenes
  /// where weight alone bends the rod (MaterialFit::camera_tilt).
  double camera_tilt = 0;
  /// Each shape in turn is left out of the fit, and predicted (MaterialFit::prediction).
  bool predict = false;
  /// Terms of natural curvature, and clamps as said, misaligned alike in all shapes or each on its
  /// own, are fitted as they predict shapes best that are left out
  /// (MaterialFit::tried); nothing is tried where the fit without them leaves nothing systematic.
  /// The numbers above say up to how many terms (three at least) and how well clamps are known (if
  /// they do not, 20 degrees of those that are alike, with a scatter of 5 and a camera that is
  /// level to 2; 5 of each shape's own). The interval of E holds that of the most terms that
  /// predict nearly as well. Three shapes or more. None: calibrate() does so if there are as many
  /// and none of these numbers is given, fit_material() does not.
  std::optional<bool> choose_options;
  /// Where residuals are systematic, and none of the above is fitted, it is tried what would remove
  /// them (MaterialFit::alternatives).
  bool alternatives = false;
  int chain_segments = 0;  ///< of a chain of hinges that is to be as stiff; 0: of none
  /// Lengths of such a chain's segments where they are unequal, 4 to 200 [m]; empty: of none.
  std::vector<double> chain_segment_lengths = {};
  int profile_points = 0;       ///< of MaterialFit::profile; 0: of none
  std::optional<double> noise;  ///< standard deviation of one coordinate [m]; else estimated
  /// Of the modulus to the scene's, where it is looked for. With what makes a wire another one than
  /// a straight rod in right clamps it is looked for up to w l^3 / (EI) = 1e5, or to 100 times the
  /// scene's if that is more.
  double smallest_ratio = 1e-4;
  double largest_ratio = 1e4;  ///< the upper end of that range
  /// A number counts as identified only if its interval's ends are within this factor of each
  /// other.
  double identified_within = 4;
  SolveOptions solve;  ///< limits of the solvers
};

/// A fitted quantity and its 95 % interval; a side without a number is open as far as was searched.
struct FittedValue {
  /// Only if the interval is closed and no wider than MaterialFitOptions::identified_within.
  std::optional<double> value;
  std::optional<double> estimate;  ///< the best one, identified or not; none: not looked for
  std::optional<double> low;       ///< lower end of the interval
  std::optional<double> high;      ///< upper end of the interval
};

/// A number that was fitted beside E and the density.
struct FittedNumber {
  std::string name;         ///< "natural curvature about d2, P_1", "direction of gripper 2"
  std::string unit;         ///< SI: "1/m", "rad" or "m"
  double value = 0;         ///< added to the scene's; the most likely one
  double deviation = 0;     ///< its standard deviation, with what was known before
  double known_before = 0;  ///< standard deviation without the shapes
  std::optional<std::size_t> shape;  ///< whose own it is; none: it is the wire's

  /// Whether the shapes tell it, rather than what was known before: of its variance half or more.
  [[nodiscard]] bool is_seen() const {
    return 2 * deviation * deviation <= known_before * known_before;
  }
};

/// Of what single shapes say of E, where it differs by more than their errors explain in less than
/// one case of twenty (Cochran's Q): shapes of one wire, hung several times, seldom repeat.
struct ScatterBetweenShapes {
  double relative_deviation = 0;  ///< of E between shapes, standard deviation [-]
  double chance = 1;              ///< of as much without a scatter [-]
  /// Width of the interval of E over that without it.
  double widening = 1;
};

/// What was not fitted, and what it would leave if it were.
struct FitAlternative {
  int natural_curvature_terms = 0;  ///< as in MaterialFitOptions
  double direction_tolerance = 0;   ///< as in MaterialFitOptions [rad]
  double rms_m = 0;                 ///< of the distances between points and rod
  FittedValue youngs_modulus;       ///< as MaterialFit::youngs_modulus
  double position_tolerance = 0;    ///< as in MaterialFitOptions [m]
  bool shared_clamps = false;       ///< as in MaterialFitOptions
  double direction_scatter = 0;     ///< as in MaterialFitOptions [rad]
  double camera_tilt = 0;           ///< as in MaterialFitOptions [rad]
  /// Prediction::rms_m, if it was looked at [m].
  std::optional<double> prediction_m = std::nullopt;
};

/// A joint of a chain of unequal segments.
struct ChainJoint {
  double at = 0;         ///< arc length [m]
  double stiffness = 0;  ///< its moment over its angle [N m/rad]
  /// The same with the energy of discrete elastic rods, as ChainSprings::binormal_stiffness.
  double binormal_stiffness = 0;
};

/// The springs with which a chain comes nearest to the fitted rod in a scene. Between unequal
/// segments each joint has its own, EI over half of both segments times `over_rod`.
struct ChainSprings {
  std::string scene;                     ///< its name
  ChainClamp clamp = ChainClamp::hinge;  ///< how clamps hold it
  int segments = 0;                      ///< those at clamps held in their middle counted whole
  double segment_length = 0;             ///< h [m]; of unequal ones the mean
  /// Of one joint between segments of that length [N m/rad], its moment over its angle.
  double stiffness = 0;
  double over_rod = 1;  ///< that over EI / h
  double rms_m = 0;     ///< of its points from the rod
  /// The same of a chain whose joints have the energy of discrete elastic rods,
  /// k (2 tan(angle/2))^2 / 2: their k [N m/rad].
  double binormal_stiffness = 0;
  /// Of unequal segments, scaled to the rod's length [m]; empty: all are equal.
  std::vector<double> segment_lengths;
  std::vector<ChainJoint> joints;  ///< of unequal segments, along the rod; else empty
};

/// How far shapes are from the rod that was fitted without them (RMS) [m].
struct Prediction {
  std::vector<double> shapes_m;  ///< of each shape, by the best fit to the others
  double rms_m = 0;              ///< of all points
  /// Of each shape from the mean of the others, measured as from a rod, as near as any rod could
  /// predict it; none of scenes whose grippers differ by more than 2 % of the length.
  std::optional<double> repeatability_m;

  /// Prediction error divided by the repeatability [-]; empty if the latter is unknown or 0.
  [[nodiscard]] std::optional<double> over_repeatability() const {
    if (!repeatability_m || !(*repeatability_m > 0)) return std::nullopt;
    return rms_m / *repeatability_m;
  }
};

/// Ratio of prediction error to repeatability from which the output states that the fit predicts
/// worse than the shapes repeat. The ratio of two such estimates from five shapes scatters by a
/// tenth.
inline constexpr double worse_than_repeatability = 1.2;

/// How one shape was laid on the rod of the fitted modulus.
struct FittedShape {
  std::string scene;    ///< its name
  Alignment alignment;  ///< of the shape on the fitted rod
  Shape rod;  ///< the fitted rod at 201 equal arc lengths; empty unless there is a profile
};

/// A point of the profile likelihood.
struct ProfilePoint {
  double stiffness = 0;  ///< as MaterialFit::youngs_modulus
  /// The sum of squares over that of the best fit, minimised over all else, as a share of what it
  /// may be at the ends of the interval: 0 at the best fit, 1 at the ends [-]. Infinite where the
  /// energy model has no shape.
  double excess_over_limit = 0;
};

/// Errors of neighbouring points that belong together.
struct CorrelatedErrors {
  double length_m = 0;  ///< arc length over which they do (to 1 / e) [m]
  double share = 0;     ///< of their variance; the rest is each point's own [-]
  /// Width of the interval of E over that for independent errors, to first order.
  double widening = 1;
  /// Of the residuals, as independent ones would have them.
  double degrees_of_freedom = 0;
};

/// A material that fits measured shapes.
struct MaterialFit {
  /// [Pa]; of a rod that is given by EI that [N m^2] (Scene::stiffness of the first scene).
  FittedValue youngs_modulus;
  /// [kg/m^3], if it was asked for and could be fitted; of a rod that is given by its mass per
  /// length that [kg/m] (Scene::heaviness).
  std::optional<FittedValue> density;
  /// GJ of the first scene [N m^2], if it was asked for.
  std::optional<FittedValue> torsional_stiffness;
  /// GJ / EI of the first scene [-], if GJ was asked for: may be identifiable where weight is too
  /// little to identify either; EI the mean of two.
  std::optional<FittedValue> torsion_over_bending;
  /// What is not identifiable from the shapes, and why; empty if all is identified.
  std::string not_identified;
  /// Given quantities whose errors may leave no residual, so that the interval of E holds only if
  /// they are right, such as "length", "weight", "natural curvature". Empty without an interval.
  std::vector<std::string> assumed;
  /// Why the fit is not to be believed: residuals far above the given noise (chance 1e-3), or above
  /// a twentieth of the length, or half of which something would remove that is not fitted; else
  /// empty.
  std::string warning;
  /// Standard deviation of one coordinate, given, or estimated and then no less than 1e-8 l, the
  /// energy model's own error.
  double noise_m = 0;
  /// The residuals were asked whether they are correlated: there are enough of them (5 degrees of
  /// freedom), and they are above the energy model's own error.
  bool correlation_was_tested = false;
  /// If independent errors would look as correlated in less than one case of twenty.
  std::optional<CorrelatedErrors> correlation;
  /// Share of the residuals' mean square across the rod that all shapes have in common at equal arc
  /// length; of independent ones 1 over their number. None of a single shape, or without a plane.
  std::optional<double> common_share;
  /// Of systematic residuals (correlated along the rod, or common to all shapes): what would leave
  /// 0.7 of them or less, the least first. The interval of E holds if nothing else is wrong.
  std::vector<FitAlternative> alternatives;
  /// With `choose_options`: what was tried, first what was chosen: the fewest numbers among those
  /// that predict as well as any (2 %). The interval of E is widened to what those say that predict
  /// nearly as well (10 %). The only one, without a prediction, if nothing systematic was left.
  std::vector<FitAlternative> tried;
  std::vector<FittedNumber> others;  ///< those that were asked for, the wire's first
  /// Of the first scene with what was fitted of it: coefficients of P_0, P_1, .. about d1 and d2
  /// [1/m]; empty if it was not asked for.
  std::vector<Eigen::Vector2d> natural_curvature;
  std::vector<ClampCorrection> clamps;                    ///< with `shared_clamps`
  Eigen::Vector3d camera_tilt = Eigen::Vector3d::Zero();  ///< as in CalibratedRod [rad]
  std::optional<Prediction> prediction;                   ///< if it was asked for
  std::optional<ScatterBetweenShapes> scatter;            ///< if there is one
  /// Of chains with as many segments as were asked for, in each different scene; none where E is
  /// not identified, or the scene has what a plain chain has not (twist, sections, natural
  /// curvature, a gripper between its joints).
  std::vector<ChainSprings> chains;
  bool noise_is_estimated = true;   ///< else it was given
  int degrees_of_freedom = 0;       ///< numbers measured less numbers fitted
  double rms_m = 0;                 ///< of the distances between points and rod at the fit
  long equilibria = 0;              ///< of the energy model that were solved
  long evaluations = 0;             ///< of its objective for these
  std::vector<FittedShape> shapes;  ///< in the order given
  /// Of Young's modulus, from half an interval's width below it to as far above, equally spaced in
  /// its logarithm.
  std::vector<ProfilePoint> profile;
};

}  // namespace dlo::compare
