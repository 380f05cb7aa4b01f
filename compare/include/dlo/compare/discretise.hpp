#pragma once

#include <vector>

#include "dlo/compare/choice.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/force_model/rod.hpp"

namespace dlo::compare {

/// How clamps hold a chain of hinges.
enum class ChainClamp {
  hinge,   ///< a hinge where the clamp is
  welded,  ///< the segment at the clamp does not rotate
  middle,  ///< the clamp is in the middle of a segment, of which half is the rod's
};

/// In words, for files and options.
template <>
struct Choices<ChainClamp> {
  /// In the enumeration's order.
  static constexpr Choice<ChainClamp> all[] = {
      {ChainClamp::hinge, "hinge", "a hinge where the clamp is"},
      {ChainClamp::welded, "welded", "the segment at the clamp does not rotate"},
      {ChainClamp::middle, "middle", "the clamp is in the middle of a segment"}};
};

/// Parameters of the force model as they follow from a scene.
struct Parameters {
  double segment_length = 0;    ///< L, nominal where segments differ [m]
  double c_b = 0;               ///< [N]; 0 for hooke
  double c_c = 0;               ///< [N]
  double design_curvature = 0;  ///< k of Formula 21 [1/m]; 0 for hooke or a given c_b
  double point_weight = 0;      ///< of an inner point [N]
};

/// A scene as points and segments.
struct Discretisation {
  force_model::Rod rod;             ///< polygon, forces and grips of the force model
  std::vector<std::size_t> walls;   ///< obstacles of the scene that rod.walls are
  std::vector<std::size_t> solids;  ///< obstacles of the scene that rod.solids are
  Eigen::Matrix3Xd weights;         ///< the part of rod.loads that is gravity [N]
  /// Where a simulation may start [m]: straight from a single gripper; two shapes for several
  /// grippers, whose slack hangs along or against the load.
  std::vector<Eigen::Matrix3Xd> starts;
  std::vector<double> arc_length;  ///< of the points; a point inside an end gripper is negative, or
                                   ///< beyond the rod's length [m]
  double length = 0;               ///< l, the rod's own part [m]
  Parameters parameters;           ///< c_b, c_c and what else follows from the scene

  /// The rod's own part, arc length 0 to l: points inside end grippers give way to the point where
  /// the gripper holds the rod.
  [[nodiscard]] Shape shape(const Eigen::Matrix3Xd& points) const;
};

/// Derives the force model of a scene.
///
/// A clamp holds two points, a pin one. `consistent`: the middle of the held segment is the clamp's
/// arc length, a segment held at the rod's end reaches L/2 beyond it, and a point weighs what the
/// halves of its segments do, of which the parts inside end grippers weigh nothing. `paper`: a
/// clamp holds the point at its arc length and the next one (at the rod's end the one before), and
/// every point weighs m g / N (of a rod with sections: what its N-th of the rod weighs). Loads
/// between two points go to both by the lever rule, which keeps their force and moment: the rod's
/// own moment differs by no more than F L/4 over one segment, which is second order like everything
/// else.
///
/// With c clamps of which e are at ends, L = l/(N - 1 - e/2) (`paper`: l/(N-1)). Held segments are
/// L long. The rod between two of them, or to a pin or a free end, has a whole number of equal
/// segments: one, and then one more wherever they are longest until all N - 1 - c are given away.
/// So they differ from L by a share of about one over their number, and only where the grips do not
/// fit a grid of N points. No such part may be shorter than L/2.
///
/// Forces and torques of both laws balance where neighbouring segments a and b differ. The paper's
/// joints are weaker there by (a - b)^2/(a + b)^2 than their mean length says, and have no
/// potential; with several grippers or one inside the rod, say so with every number.
///
/// A joint stands for the rod between its segments' middles: its EI, over an end of a section too,
/// is that of the mean 1/EI (of the law `paper` c_b goes with it), and its turn at rest the natural
/// curvature times its length. The law `paper`, and a rod that does not lie in its plane, leave the
/// natural curvature out. GJ goes with EI where the clamps twist the rod and the law is hooke;
/// their frames are no part of this, as whole turns are counted from where the rod rests without
/// twist.
///
/// A half-space is a wall of the force model, which acts on points, each with L times the
/// obstacle's stiffness, as walls have one stiffness for all points (the last point of a free end
/// has twice its share); other bodies are solids, which act all along the segments. A rigid
/// obstacle gets c_c / L: as stiff as the rod's own segments, so that points enter it by the weight
/// of a segment over c_c / L; stiffer ones would only slow the steps down. Obstacles out of the
/// rod's reach are left out; who moves grips afterwards takes set_obstacles().
/// @throws InputError if there are too few points for the grippers (with the number needed), two
/// grippers hold the same arc length, grippers, or the segments that they hold, are further apart
/// than the rod between them, or a single segment between two held points does not fit (with the
/// number of points that do), or a joint would rotate by 3 rad or more at rest
[[nodiscard]] Discretisation discretise(const Scene& scene, const ForceModelSettings& settings);

/// Gives a discretisation the walls and solids of these obstacles of a scene, and no others.
void set_obstacles(const Scene& scene, const std::vector<std::size_t>& obstacles,
                   Discretisation& discretisation);

/// Largest share by which a segment's length may differ from its rest length in a result [-]: a
/// hundredth, so that a rod that is stretched or crushed because its polygon is too coarse, or its
/// solver lost, is not taken for a shape. Who gives a c_c of A E or less asks for the stretch: a
/// half, beyond which a segment is crushed or torn.
[[nodiscard]] double largest_strain(const Scene& scene, const ForceModelSettings& settings);

}  // namespace dlo::compare
