#pragma once

#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/force_model/rod.hpp"

namespace dlo::compare {

/// How clamps hold a chain of hinges.
enum class ChainClamp {
  hinge,   ///< a hinge at the position of the clamp
  welded,  ///< the segment at the clamp does not rotate
  middle,  ///< the clamp is in the middle of a segment, of which half is the rod's
};

/// Names of the clamps in files and options.
template <>
struct Choices<ChainClamp> {
  /// All values, in the order of the enumeration.
  static constexpr Choice<ChainClamp> all[] = {
      {ChainClamp::hinge, "hinge", "a hinge where the clamp is"},
      {ChainClamp::welded, "welded", "the segment at the clamp does not rotate"},
      {ChainClamp::middle, "middle", "the clamp is in the middle of a segment"}};
};

/// Parameters of the force model that follow from a scene.
struct Parameters {
  double segment_length = 0;    ///< L [m]; the nominal value if segments differ
  double c_b = 0;               ///< [N]; 0 for hooke
  double c_c = 0;               ///< [N]
  double design_curvature = 0;  ///< k of Formula 21 [1/m]; 0 for hooke or a given c_b
  double point_weight = 0;      ///< weight of an inner point [N]
};

/// A scene discretised into points and segments.
struct Discretisation {
  force_model::Rod rod;             ///< polygon, forces and grips of the force model
  std::vector<std::size_t> walls;   ///< index in the scene of each obstacle in rod.walls
  std::vector<std::size_t> solids;  ///< index in the scene of each obstacle in rod.solids
  Eigen::Matrix3Xd weights;         ///< part of rod.loads that is the rod's own weight [N]
  /// Start shapes of a simulation [m]: for a single gripper one, straight except along obstacles;
  /// for several grippers two, with the slack along and against the load.
  std::vector<Eigen::Matrix3Xd> starts;
  /// Arc lengths of the points [m]. Points inside a gripper at an end have negative values or
  /// values beyond the rod's length.
  std::vector<double> arc_length;
  double length = 0;      ///< l, the rod's own part [m]
  Parameters parameters;  ///< c_b, c_c and what else follows from the scene

  /// Returns the rod's own part, arc length 0 to l: a point inside an end gripper is replaced by
  /// the point where the gripper holds the rod.
  [[nodiscard]] Shape shape(const Eigen::Matrix3Xd& points) const;
};

/// Derives the force model of a scene.
///
/// A clamp holds two points, a pin one. `consistent`: the clamp's arc length is the middle of the
/// held segment, a segment held at the rod's end extends L/2 beyond it, and the weight of a point
/// is that of the adjacent halves of its segments; the parts inside end grippers have no weight.
/// `paper`: a clamp holds the point at its arc length and the following one (at the rod's end the
/// preceding one), and every point has the weight m g / N (of a rod with sections: that of the
/// corresponding N-th of the rod). A distributed load acts on each point with its part
/// between the middles of the adjacent segments. A point load between two points is distributed to
/// both by the lever rule, which preserves its force and moment: the rod's own moment differs by at
/// most F L/4 over one segment, which is second order like all other errors.
///
/// With c clamps of which e are at ends, L = l/(N - 1 - e/2) (`paper`: l/(N-1)). Held segments have
/// the length L. The rod between two of them, or to a pin or a free end, is divided into equal
/// segments: first one in each interval, then one more where the segments are longest, until all of
/// the N - 1 - c are assigned. The relative difference from L is therefore about one over the
/// number of segments, and zero if the grips fit a grid of N points. No such interval may be
/// shorter than L/2.
///
/// Forces and torques of both laws balance if adjacent segments a and b differ. The paper's joints
/// are weaker there, by the relative amount (a - b)^2/(a + b)^2 of the stiffness at their mean
/// length, and have no potential; results with several grippers or one inside the rod should state
/// this.
///
/// A joint represents the rod between the middles of its segments. Its EI is that of the mean 1/EI,
/// also across an end of a section (c_b of the law `paper` is proportional to it), and its angle at
/// rest is the natural curvature times its length. The natural curvature is neglected by the law
/// `paper`, and if the rod is not in its plane. GJ, used if the clamps twist a naturally straight
/// rod and the law is hooke, is likewise that of the mean 1/GJ. The clamps' frames are not set
/// here, because whole turns are counted from the untwisted equilibrium.
///
/// A half-space becomes a wall of the force model, which acts on points. Each point has the
/// stiffness L times the obstacle's, since walls have one stiffness for all points (the last point
/// of a free end has twice its share). Other bodies become solids, which act along the segments. A
/// rigid obstacle has the stiffness c_c / L, that of the rod's own segments: points penetrate it by
/// the weight of a segment divided by c_c / L, and a stiffer one would only require smaller steps.
/// Obstacles out of the rod's reach are omitted; callers that move grips afterwards call
/// set_obstacles().
/// @throws InputError if there are too few points for the grippers (with the number needed), two
/// grippers hold the same arc length, grippers, or the segments that they hold, are further apart
/// than the rod between them, or a single segment between two held points does not fit (with the
/// number of points that do), a joint would rotate by 3 rad or more at rest, or by pi or more or
/// not at all at the design curvature, or the scene or the settings have what no polygon has: two
/// bending stiffnesses, couples, loads without a potential, a `joint_law`, natural curvature in a
/// plane other than z = 0
[[nodiscard]] Discretisation discretise(const Scene& scene, const ForceModelSettings& settings);

/// Replaces the walls and solids of a discretisation by the given obstacles of a scene.
void set_obstacles(const Scene& scene, const std::vector<std::size_t>& obstacles,
                   Discretisation& discretisation);

/// Returns the largest relative change of a segment's length in a result [-]: a hundredth, so that
/// a rod that is stretched or compressed because its polygon is too coarse, or because the solver
/// diverged, is not accepted as a shape. If the settings give c_c <= EA, stretch is intended and
/// the limit is a half, beyond which a segment is crushed or torn.
[[nodiscard]] double largest_strain(const Scene& scene, const ForceModelSettings& settings);

}  // namespace dlo::compare
