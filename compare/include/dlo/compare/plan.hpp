#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// What a scene is planned for.
struct PlanOptions {
  double target = 1e-3;  ///< wanted error, RMS over the rod's length [-], > 0
  /// Fastest that a gripper moves, starts or stops [m/s], >= 0; 0: the scene stands still.
  double gripper_speed = 0;
  /// Of all that the plan solves [s], > 0; what is not known by then has no bound.
  double time_limit = 5;
};

/// A part of the rod that can be solved by itself: from clamp to clamp or end.
struct PlannedSpan {
  double begin = 0;        ///< arc length [m]
  double end = 0;          ///< arc length [m]
  int inner_pins = 0;      ///< pins strictly inside
  std::string begin_held;  ///< "clamp", "pin" or "free"
  std::string end_held;    ///< the same of its end
};

/// An obstacle and the rod's reach.
struct PlannedObstacle {
  double clearance = 0;  ///< least distance that any point of the rod keeps from it, however it
                         ///< bends [m]; negative: some could enter it
  bool in_reach = true;  ///< some point of the rod could touch it
};

/// A part of the rod between clamps that hold its frame.
struct PlannedTwist {
  double begin = 0;  ///< arc length [m]
  double end = 0;    ///< arc length [m]
  /// By which the grippers turn the end ahead of the begin [rad]; NaN where their directors say it.
  double turn = 0;
  /// What of it the rod takes up as twist [rad]; NaN where it was not solved.
  double twist = std::numeric_limits<double>::quiet_NaN();
};

/// What a model neglects, with the most that it could change.
struct Neglected {
  std::string what;    ///< short name, as Plan::bound takes it
  std::string models;  ///< that neglect it
  /// Of the shape, RMS along the rod [m]; infinite: no bound, or it cannot be neglected.
  double bound_m = 0;
  std::string why;  ///< how the bound comes about
};

/// What a scene needs, decided before it is solved.
struct Plan {
  double gamma = 0;                ///< w l^3 / (EI) [-]
  double target = 0;               ///< PlanOptions::target
  bool planar = false;             ///< grips, loads and obstacles in reach lie in one plane
  bool moving = false;             ///< the gripper moves so fast that the rod's inertia counts
  bool stretch = false;            ///< its bound is above a tenth of the target
  std::vector<PlannedSpan> spans;  ///< by growing arc length
  std::vector<PlannedObstacle> obstacles;  ///< as in the scene
  bool frame_held = false;                 ///< a gripper holds the rod's frame
  std::vector<PlannedTwist> twist;  ///< by growing arc length; one frame alone twists nothing
  /// N at which the hooke polygon with the scene's bookkeeping meets the target; 0: none up to
  /// `most_planned_points`, or unknown.
  int points = 0;
  int scene_points = 0;              ///< N of the scene
  bool contact = false;              ///< the rod touches an obstacle, or it was not found out
  std::vector<Neglected> neglected;  ///< everything that any of the models neglects

  /// Bound of one thing neglected [m]. @throws std::invalid_argument if there is no such thing
  [[nodiscard]] double bound(const std::string& what) const;
};

/// Largest N that a plan asks for.
inline constexpr int most_planned_points = 4000;

/// Decides what a scene needs, and bounds what is neglected.
///
/// - Planar if the scene is; the energy model checks that a planar shape is stable out of its
/// plane.
/// - Spans: clamps hold position and direction, so nothing but the shape's own energy passes.
/// - Obstacles: those that no point of the rod can reach are left out.
/// - Stretch, shear and the polygon: twice the first-order answer of the rod's own shape
///   (PolygonResponse), while that is below 3 % of the length and the answer's matrix far from
///   singular: next to buckling or snapping the shape's next terms decide, and of a symmetric rod
///   the first vanishes. Else they are said to have no bound.
///   The shape is the energy model's, solved once, without obstacles out of reach; a rod that
///   touches an obstacle has no bound either, since where it touches may change.
///   Shear: k G >= 0.3 E. A round section has k = 6 (1 + nu) / (7 + 6 nu) (Cowper 1966) and
///   G = E / (2 (1 + nu)), so kG = 3 E / (7 + 6 nu), least for nu = 1/2.
/// - Polygon: that answer at the scene's N falls with L^2 (`consistent`) or L (`paper`), from which
///   N follows; besides, no joint rotates by more than 0.5 rad (Formula 10). The law `paper` has an
///   error of its own that no N removes, so this is said of the hooke law only.
/// - Motion: a gripper that starts or stops at speed v gives the rod the energy rho A l v^2 / 2 at
///   most; a rod held by a clamp or two grips bends by 3 EI d^2 / (2 l^3) or more for a deflection
///   d, so the rod leaves its static shape by d <= v l^2 sqrt(rho A / (3 EI)) (small deflections).
///   A single pin lets the rod swing: no bound.
/// - Twist: a round, naturally straight rod whose grips leave the twist free has none: nothing.
///   Where two clamps hold frames, chain and force neglect it with the law paper, or of a rod
///   that is intrinsically curved, and no polygon says what stretch, shear and itself change (the
///   one that answers has no twist); nor does one of a rod with sections or that is intrinsically
///   curved.
/// - Natural curvature: what chain and force neglect, in space or with the law paper.
/// A scene that cannot be planned in time or at all has a plan without bounds, and why.
/// @throws std::invalid_argument if an option is out of range
[[nodiscard]] Plan make_plan(const Scene& scene, const PlanOptions& options = {});

}  // namespace dlo::compare
