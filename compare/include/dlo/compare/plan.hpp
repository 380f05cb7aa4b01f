#pragma once

#include <limits>
#include <string>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

/// Options of a plan.
struct PlanOptions {
  double target = 1e-3;  ///< requested error, RMS along the rod divided by its length [-], > 0
  /// Largest speed with which a gripper moves, starts or stops [m/s], >= 0; 0: the scene is static.
  double gripper_speed = 0;
  /// Time limit of all solves of the plan [s], > 0; quantities that are unknown by then have no
  /// bound.
  double time_limit = 5;
};

/// An interval of the rod that can be solved separately: between clamps, or a clamp and an end.
struct PlannedSpan {
  double begin = 0;           ///< arc length [m]
  double end = 0;             ///< arc length [m]
  int inner_pins = 0;         ///< number of pins strictly inside
  std::string begin_support;  ///< support at `begin`: "clamp", "pin" or "free"
  std::string end_support;    ///< support at `end`: "clamp", "pin" or "free"
};

/// Reach of the rod towards an obstacle.
struct PlannedObstacle {
  /// Lower bound of the distance between the rod's points and the obstacle in any shape [m];
  /// negative: some point might enter it.
  double clearance = 0;
  bool in_reach = true;  ///< whether the rod, or a polygon whose segments stretch, could touch it
};

/// An interval of the rod between clamps that hold its frame.
struct PlannedTwist {
  double begin = 0;  ///< arc length [m]
  double end = 0;    ///< arc length [m]
  /// Rotation of the end relative to the begin by the grippers [rad]; NaN if the clamps give it by
  /// their directors.
  double turn = 0;
  /// Part of `turn` that becomes twist of the rod [rad]; NaN if it was not solved.
  double twist = std::numeric_limits<double>::quiet_NaN();
};

/// An effect that a model neglects, with a bound of its influence.
struct Neglected {
  std::string name;    ///< short name, as in Plan::bound
  std::string models;  ///< models that neglect it
  /// Bound of the change of the shape, RMS along the rod [m]; infinite: no bound, or not
  /// negligible.
  double bound_m = 0;
  std::string why;  ///< derivation of the bound
};

/// Requirements of a scene, determined before it is solved.
struct Plan {
  double gamma = 0;     ///< w l^3 / (EI) [-]
  double target = 0;    ///< PlanOptions::target
  bool planar = false;  ///< Scene::planar()
  bool moving = false;  ///< whether the gripper moves so fast that the rod's inertia matters
  /// Whether the bound of stretch is above a tenth of the target; false if the scene counts
  /// stretch.
  bool stretch = false;
  std::vector<PlannedSpan> spans;          ///< by increasing arc length
  std::vector<PlannedObstacle> obstacles;  ///< in the scene's order
  bool frame_held = false;                 ///< whether a gripper holds the rod's frame
  /// Intervals that may twist, by increasing arc length; empty if a single frame is held.
  std::vector<PlannedTwist> twist;
  /// N at which the polygon of law hooke, with the scene's bookkeeping, meets the target; 0: none
  /// up to `most_planned_points`, or unknown.
  int points = 0;
  int scene_points = 0;  ///< N of the scene
  bool contact = false;  ///< whether the rod touches an obstacle; also true if this is unknown
  std::vector<Neglected> neglected;  ///< all effects that any of the models neglects

  /// Returns the bound of a neglected effect [m].
  /// @throws std::invalid_argument if there is no such effect
  [[nodiscard]] double bound(const std::string& what) const;
};

/// Largest N that a plan recommends.
inline constexpr int most_planned_points = 4000;

/// Determines what a scene needs, and bounds the neglected effects.
///
/// - Plane: a scene is planar if plane_normal() exists; the energy model checks that a planar shape
///   is stable out of its plane.
/// - Spans: clamps hold position and direction, so that spans are coupled only through the energy
///   of the shape.
/// - Obstacles: those that no point of the rod can reach are ignored.
/// - Stretch, shear and the polygon: the bound is twice the first-order response of the rod's shape
///   (PolygonResponse), if that is below 3 % of the length and the response matrix is far from
///   singular. Near buckling or snapping, higher-order terms dominate, and the first-order term of
///   a symmetric rod vanishes; then there is no bound. The shape is the energy model's, solved
///   once, without obstacles out of reach. A rod that touches an obstacle has no bound either,
///   since the contact may move.
///   Shear: k G >= 0.3 E. A round section has k = 6 (1 + nu) / (7 + 6 nu) (Cowper 1966) and
///   G = E / (2 (1 + nu)), so kG = 3 E / (7 + 6 nu), least for nu = 1/2.
/// - Polygon: that response at the scene's N decreases with L^2 (`consistent`) or L (`paper`),
///   which gives N; in addition, no joint rotates by more than 0.5 rad (Formula 10). The law
///   `paper` has an error that no N removes, so N is given for the law hooke only.
/// - Motion: a gripper that starts or stops at speed v gives the rod the energy rho A l v^2 / 2 at
///   most; a rod held by a clamp or two grips bends by 3 EI d^2 / (2 l^3) or more for a deflection
///   d, so the rod leaves its static shape by d <= v l^2 sqrt(rho A / (3 EI)) (small deflections).
///   A single pin lets the rod swing: no bound.
/// - Twist: a round, naturally straight rod whose grips leave the twist free has none; nothing is
///   neglected. If two clamps hold frames, chain and force neglect twist with the law paper and in
///   an intrinsically curved or twisted rod. No polygon then bounds stretch, shear and its own
///   error, since the polygon of the response has no twist. Nor does that of a rod with sections,
///   natural curvature, two bending stiffnesses or couples.
/// - Natural curvature: chain and force neglect it in space and with the law paper.
/// The plan of a scene that cannot be planned in time, or not at all, has no bounds and states why.
/// @throws std::invalid_argument if an option is out of range
[[nodiscard]] Plan make_plan(const Scene& scene, const PlanOptions& options = {});

}  // namespace dlo::compare
