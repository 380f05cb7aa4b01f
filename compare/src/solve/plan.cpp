#include "dlo/compare/plan.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>

#include "base/timer.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/force_model/heuristics.hpp"
#include "polygon/natural_plane.hpp"
#include "polygon/polygon_response.hpp"
#include "scene/scene_problem.hpp"
#include "solve/held_frames.hpp"

namespace dlo::compare {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double largest_joint_angle = 0.5;  // [rad]

std::vector<PlannedSpan> spans_of(const Scene& scene) {
  std::vector<PlannedSpan> spans;
  PlannedSpan span{.begin_support = "free"};
  for (const Gripper* gripper : grippers_by_arc_length(scene)) {
    const std::string held = gripper->direction ? "clamp" : "pin";
    if (gripper->at == 0) {
      span.begin_support = held;
    } else if (gripper->at == scene.length) {
      span.end_support = held;
    } else if (!gripper->direction) {
      ++span.inner_pins;
    } else {
      span.end = gripper->at;
      span.end_support = held;
      spans.push_back(span);
      span = {.begin = gripper->at, .begin_support = held};
    }
  }
  span.end = scene.length;
  if (span.end_support.empty()) span.end_support = "free";
  spans.push_back(span);
  return spans;
}

/// Returns the parts between neighbouring clamps that hold frames. Their turn is the difference of
/// the rolls; NaN if a clamp other than the first one has a d1.
std::vector<PlannedTwist> twists_of(const Scene& scene) {
  std::vector<PlannedTwist> twists;
  const std::vector<std::size_t> framed = framed_grippers(scene);
  for (std::size_t k = 1; k < framed.size(); ++k) {
    const Gripper& before = scene.grippers[framed[k - 1]];
    const Gripper& after = scene.grippers[framed[k]];
    const bool by_directors = after.frame->d1 || (k > 1 && before.frame->d1);
    twists.push_back({.begin = before.at,
                      .end = after.at,
                      .turn = by_directors ? std::numeric_limits<double>::quiet_NaN()
                                           : after.frame->roll - before.frame->roll});
  }
  return twists;
}

/// Returns the shape of the rod; std::nullopt if the energy model finds none, as for a taut rod, or
/// does not support the scene.
/// @param[out] why  the reason
std::optional<energy_model::Equilibrium> rod_shape(const Scene& scene, double time_limit,
                                                   std::string& why) {
  try {
    SolveOptions options;
    options.time_limit = time_limit;
    return solve_reference(scene, Model::energy, options);
  } catch (const ConvergenceError&) {
    why = "the energy model did not converge";
  } catch (const InputError& error) {
    why = error.what();
  }
  return std::nullopt;
}

double bound_at(const Scene& scene, const energy_model::Equilibrium& rod, int points) {
  const std::optional<Discretisation> polygon = hooke_polygon(scene, points);
  return polygon ? polygon_bound(scene, *polygon, rod) : unbounded;
}

/// Returns a number of points with which the bound of the polygon's error meets the target, found
/// by extrapolation with the order of convergence; 0 if time is up, or no N up to
/// most_planned_points does.
int points_for_target(const Scene& scene, const energy_model::Equilibrium& rod, double target,
                      const TimeLimit& time) {
  const std::vector<double> s = equal_arc_lengths(scene.length, rod_points);
  const double curvature = std::sqrt(rod.sample(s).curvature.colwise().squaredNorm().maxCoeff());
  int points = 5;
  if (curvature * scene.length > largest_joint_angle) {
    points = force_model::points_for_radius(scene.length, 1 / curvature, largest_joint_angle);
  }
  const double order = scene.force_model.bookkeeping == Bookkeeping::consistent ? 2 : 1;
  while (points <= most_planned_points && time.left() > 0) {
    const double bound = bound_at(scene, rod, points);
    if (bound <= target * scene.length) return points;
    const double growth =
        std::isfinite(bound) ? std::pow(bound / (target * scene.length), 1 / order) : 1.5;
    // The steps are cautious, because the order of convergence only appears with short segments.
    points += std::max(1, static_cast<int>(0.7 * points * (std::min(growth, 8.0) - 1)));
  }
  return 0;
}

Neglected inertia(const Scene& scene, double speed) {
  Neglected result{.name = "inertia", .models = "all but a simulation in time"};
  if (speed == 0) {
    result.why = "nothing moves";
    return result;
  }
  const bool swings = scene.grippers.size() == 1 && !scene.grippers.front().direction;
  const double mass_per_length = scene.mass() / scene.length;
  result.bound_m = swings ? unbounded
                          : speed * scene.length * scene.length *
                                std::sqrt(mass_per_length / (3 * scene.softer_bending_stiffness()));
  result.why =
      swings ? "a rod on one pin swings" : "kinetic energy of a start or stop at the gripper speed";
  return result;
}

Neglected neglected_twist(const Scene& scene, const Plan& plan) {
  if (scene.prescribes_twist()) {
    ForceModelSettings hooke = scene.force_model;
    hooke.law = BendingLaw::hooke;
    return {"twist", models_twist(scene, hooke) ? "chain, force (law paper only)" : "chain, force",
            unbounded, "the grippers hold the rod's frame"};
  }
  if (!scene.has_material_directors()) {
    return {"twist", "all", 0,
            "no twist of a round, intrinsically straight rod that is free to rotate"};
  }
  // A strip may buckle out of its plane.
  if (plan.planar && !scene.has_two_stiffnesses()) {
    return {"twist", "chain, force", 0, "no twist of a planar shape"};
  }
  return {"twist", "chain, force", unbounded,
          scene.naturally_bent() ? "a rod that is intrinsically curved twists in space"
                                 : "a rod of two bending stiffnesses twists in space"};
}

Neglected neglected_natural(const Scene& scene) {
  ForceModelSettings hooke = scene.force_model;
  hooke.law = BendingLaw::hooke;
  return {"natural curvature",
          models_natural_curvature(scene, hooke) ? "chain, force (law paper only)" : "chain, force",
          unbounded, "the rod is curved without loads"};
}

Neglected neglected_friction(const Plan& plan) {
  return {"friction", "all", unbounded,
          plan.contact ? "with friction, other shapes are in equilibrium too"
                       : "no contact in this shape; friction could hold a shape that touches"};
}

/// Sets the effect of neglecting something, the distance from the lowest shape without it, if time
/// is left and that shape is found.
void set_neglect_effect(const Scene& without, const energy_model::Equilibrium& rod,
                        double time_limit, Neglected& item) {
  if (!(time_limit > 0)) return;
  std::string why;
  const std::optional<energy_model::Equilibrium> other = rod_shape(without, time_limit, why);
  if (!other) return;
  const std::vector<double> s = equal_arc_lengths(without.length, rod_points);
  item.bound_m = rms(s, rod.sample(s).points - other->sample(s).points);
  item.why = "distance from the lowest shape without it";
}

/// Neglected effects whose bounds follow from the shape of the rod.
struct ShapeBounds {
  Neglected stretch{.name = "stretch", .models = "energy, exact, chain of rigid segments"};
  Neglected shear{.name = "shear", .models = "all"};
  Neglected polygon{.name = "polygon", .models = "chain, force"};
  Neglected twist;
  Neglected natural;

  /// Sets the bounds that the response of a polygon would give.
  void set_unbounded(const std::string& why) {
    for (Neglected* item : {&stretch, &shear, &polygon}) {
      item->bound_m = unbounded;
      item->why = why;
    }
  }
};

/// Returns the parts of a plan that need no solution.
Plan plan_of(const Scene& scene, double target) {
  const std::vector<std::size_t> in_reach = obstacles_in_reach(scene, scene.force_model);
  const std::vector<double> clearances = obstacle_clearances(scene);
  Plan plan;
  plan.gamma = scene.gamma();
  plan.target = target;
  plan.planar = scene.planar();
  plan.contact = true;
  plan.spans = spans_of(scene);
  plan.twist = twists_of(scene);
  plan.frame_held = std::any_of(scene.grippers.begin(), scene.grippers.end(),
                                [](const Gripper& gripper) { return gripper.frame.has_value(); });
  plan.scene_points = scene.force_model.points;
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    plan.obstacles.push_back(
        {clearances[i], std::find(in_reach.begin(), in_reach.end(), i) != in_reach.end()});
  }
  return plan;
}

/// Sets the bounds of a rod without contact, by the response of a fine polygon.
void bound_by_response(const Scene& scene, const energy_model::Equilibrium& rod,
                       const Discretisation& fine, ShapeBounds& bounds) {
  const PolygonResponse response(scene, fine, rod);
  if (scene.given_axial_stiffness || scene.cross_section() > 0) {
    const double EA = scene.axial_stiffness();
    bounds.stretch.bound_m = bound_of_response(response.stretch(EA).displacement_m, scene.length);
    bounds.stretch.why = "response to the axial strain, tension over EA";
    bounds.shear.bound_m = bound_of_response(response.shear(0.3 * EA), scene.length);
    bounds.shear.why = "response to shear, transverse force over kGA, kG >= 0.3 E";
  } else {
    for (Neglected* item : {&bounds.stretch, &bounds.shear}) {
      item->bound_m = unbounded;
      item->why = "neither the section nor axial_stiffness is given";
    }
  }
  bounds.polygon.bound_m = bound_at(scene, rod, scene.force_model.points);
  bounds.polygon.why =
      fmt::format("segments instead of curves, hooke law, bookkeeping {}, N = {}",
                  to_string(scene.force_model.bookkeeping), scene.force_model.points);
}

void bound_by_shape(const Scene& scene, const PlanOptions& options, ShapeBounds& bounds,
                    Plan& plan) {
  const TimeLimit time(options.time_limit);
  std::string why;
  const std::optional<energy_model::Equilibrium> rod = rod_shape(scene, options.time_limit, why);
  plan.contact = !rod || touches_obstacle(*rod);
  if (rod && !plan.twist.empty()) {
    const bool has_all = rod->twists.size() == plan.twist.size();
    for (std::size_t i = 0; has_all && i < plan.twist.size(); ++i) {
      plan.twist[i].twist = rod->twists[i].angle;
    }
    set_neglect_effect(scene.without_twist(), *rod, time.left(), bounds.twist);
  }
  if (rod && scene.naturally_bent()) {
    set_neglect_effect(scene.without_natural_strain(), *rod, time.left(), bounds.natural);
  }
  const std::optional<Discretisation> fine = hooke_polygon(scene, rod_points);
  if (!rod) {
    bounds.set_unbounded(why);
  } else if (plan.contact) {
    bounds.set_unbounded("the rod touches an obstacle");
  } else if (const std::string none = why_no_polygon(scene); !none.empty()) {
    bounds.set_unbounded(none);
  } else if (!fine) {
    bounds.set_unbounded("the grips are closer than points of the finest polygon tried");
  } else {
    bound_by_response(scene, *rod, *fine, bounds);
    plan.points = points_for_target(scene, *rod, options.target, time);
  }
}

}  // namespace

double Plan::bound(const std::string& what) const {
  for (const Neglected& item : neglected) {
    if (item.name == what) return item.bound_m;
  }
  throw std::invalid_argument(fmt::format("Plan::bound: no neglected effect \"{}\"", what));
}

Plan make_plan(const Scene& scene, const PlanOptions& options) {
  if (!(options.target > 0) || !(options.gripper_speed >= 0) || !(options.time_limit > 0)) {
    throw std::invalid_argument(fmt::format(
        "make_plan: target = {} (allowed: > 0), gripper_speed = {} (>= 0), time_limit = {} (> 0)",
        options.target, options.gripper_speed, options.time_limit));
  }
  // A rod that stretches is planned with its shape without stretch.
  Scene inextensible = scene;
  inextensible.stretch = Stretch::none;
  Plan plan = plan_of(inextensible, options.target);
  ShapeBounds bounds;
  bounds.twist = neglected_twist(inextensible, plan);
  bounds.natural = neglected_natural(inextensible);
  try {
    bound_by_shape(inextensible, options, bounds, plan);
  } catch (const std::exception& error) {
    // A failing plan must not make a solve fail.
    bounds.set_unbounded(fmt::format("not computed: {}", error.what()));
  }
  const bool counted = scene.stretch == Stretch::counted;
  plan.stretch = !counted && bounds.stretch.bound_m > options.target * inextensible.length / 10;
  plan.neglected = {bounds.shear, bounds.polygon, inertia(inextensible, options.gripper_speed),
                    bounds.twist};
  if (!counted) plan.neglected.insert(plan.neglected.begin(), bounds.stretch);
  if (inextensible.naturally_bent()) plan.neglected.push_back(bounds.natural);
  if (is_friction_in_reach(inextensible)) plan.neglected.push_back(neglected_friction(plan));
  plan.moving = plan.bound("inertia") > options.target * inextensible.length;
  const auto all = plan.obstacles.size();
  const auto out = static_cast<std::size_t>(
      std::ranges::count(plan.obstacles, false, &PlannedObstacle::in_reach));
  if (out > 0) {
    plan.neglected.push_back({"obstacles out of reach", "all", 0,
                              fmt::format("{} of {}: no point of the rod gets there", out, all)});
  }
  return plan;
}

}  // namespace dlo::compare
