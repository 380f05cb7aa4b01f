#include "problem/split.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/couple_zero.hpp"
#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Interval of arc length of a span [m], and whether clamps hold its ends.
struct SpanInterval {
  double begin = 0, end = 0;
  bool clamped_begin = false, clamped_end = false;

  [[nodiscard]] bool contains(double at) const { return at >= begin && at <= end; }
  [[nodiscard]] bool is_between_clamps() const { return clamped_begin && clamped_end; }
};

/// Directions that determine a span's frame, in space.
struct Directions {
  /// Unit directions of clamps and chords, normals of half-spaces, and two across each couple.
  std::vector<Eigen::Vector3d> grips;
  std::vector<Eigen::Vector3d> forces;
};

void choose_frame(PlacedSpan& placed, const Directions& directions) {
  // find_plane() takes one vector as the direction of the rod and compares the others with the
  // largest of them, so directions of grips have length 1 and forces at most length 1.
  Eigen::Vector3d first = Eigen::Vector3d::UnitX();
  std::vector<Eigen::Vector3d> others;
  others.reserve(directions.forces.size() + directions.grips.size());
  double largest = 0;
  for (const Eigen::Vector3d& force : directions.forces) {
    if (!(force.norm() > largest)) continue;
    largest = force.norm();
    first = force / largest;
  }
  for (const Eigen::Vector3d& force : directions.forces) {
    if (largest > 0) others.emplace_back(force / largest);
  }
  others.insert(others.end(), directions.grips.begin(), directions.grips.end());
  if (!directions.grips.empty()) first = directions.grips.front();
  const std::optional<Plane> plane = find_plane(Eigen::Vector3d::Zero(), first, others);
  placed.span.planar = plane.has_value();
  if (plane) {
    placed.frame << plane->x.transpose(), plane->y.transpose(), plane->normal().transpose();
  } else {
    // Any frame is valid; a rod without clamps starts nearly along this x.
    const Eigen::Vector3d across = first.unitOrthogonal();
    placed.frame << first.transpose(), across.transpose(), first.cross(across).transpose();
  }
}

void turn_vectors(Span& span, const Eigen::Matrix3d& rotation) {
  const auto turn = [&](Eigen::Vector3d& v) { v = (rotation * v).eval(); };
  if (span.start_direction) turn(*span.start_direction);
  if (span.end_direction) turn(*span.end_direction);
  for (Span::Hold& hold : span.holds) {
    turn(hold.offset);
    if (hold.direction) turn(*hold.direction);
  }
  for (Span::Load& load : span.loads) turn(load.force);
  const Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
  const auto turn_body = [&](Span::Obstacle& obstacle) {
    obstacle.body = obstacle.body.transformed(anchor, rotation, 1);
  };
  for (Span::SoftObstacle& obstacle : span.soft_obstacles) turn_body(obstacle);
  for (Span::Obstacle& obstacle : span.rigid_obstacles) turn_body(obstacle);
  for (Span::Part& part : span.parts) turn(part.weight);
  for (LineLoad& load : span.line_loads) {
    turn(load.at_begin);
    turn(load.at_end);
  }
  turn(span.weight);
}

/// Whether all obstacles leave a planar shape in its plane.
bool are_symmetric(const Span& span) {
  const auto symmetric = [&span](const Span::Obstacle& obstacle) {
    return obstacle.body.is_symmetric(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(),
                                      span.length);
  };
  return std::ranges::all_of(span.soft_obstacles, symmetric) &&
         std::ranges::all_of(span.rigid_obstacles, symmetric);
}

/// Adds the sections of the rod between two arc lengths to a span that runs from placed.start on.
void place_sections(const Problem& problem, const SpanInterval& stretch, PlacedSpan& placed) {
  const double l = problem.length;
  const double force_unit = bending_unit(problem) / (l * l);
  for (const Section& section : problem.sections) {
    const double from = std::max(stretch.begin, section.begin);
    const double to = std::min(stretch.end, section.end);
    if (!(to > from)) continue;
    const double a = placed.s_of(from, l);
    const double b = placed.s_of(to, l);
    const Eigen::Vector3d more = section.weight_per_length - problem.weight_per_length;
    placed.span.parts.push_back({std::min(a, b), std::max(a, b),
                                 principal_stiffness(section, bending_unit(problem)),
                                 more * l / force_unit});
  }
  if (placed.reversed) std::reverse(placed.span.parts.begin(), placed.span.parts.end());
}

/// Adds the line loads between two arc lengths that are not contained in the span's weight.
void place_line_loads(const Problem& problem, const SpanInterval& stretch, PlacedSpan& placed) {
  const double l = problem.length;
  const double unit = bending_unit(problem) / (l * l * l);
  for (const LineLoad& load : problem.line_loads) {
    const double from = std::max(stretch.begin, load.begin);
    const double to = std::min(stretch.end, load.end);
    if (is_uniform_over_rod(load, problem) || !(to > from)) continue;
    LineLoad own{placed.s_of(from, l), placed.s_of(to, l),
                 (load.at_begin + (from - load.begin) * load.slope()) / unit,
                 (load.at_begin + (to - load.begin) * load.slope()) / unit};
    if (placed.reversed) {
      std::swap(own.begin, own.end);
      std::swap(own.at_begin, own.at_end);
    }
    placed.span.line_loads.push_back(own);
  }
}

/// Returns the frames that two clamps hold, in the axes of the span between them; std::nullopt if
/// they do not twist the rod.
std::optional<HeldFrames> frames_of(const Problem& problem, const OrderedGrip& start,
                                    const Grip& end, const Eigen::Matrix3d& axes) {
  if (!end.frame || !(has_material_directors(problem) || start.grip->frame)) return std::nullopt;
  // The first clamp of a rod with material directors holds them with or without a frame.
  Grip first = *start.grip;
  if (!first.frame) first.frame = FrameHold{};
  // Mean GJ between the clamps: GJ of a uniform rod with the same torsional compliance.
  const double mean =
      (end.at - first.at) / torsional_compliance(rod_parts(problem), first.at, end.at);
  return HeldFrames{.stiffness = mean / bending_unit(problem),
                    .start_d1 = axes * held_d1(problem, first),
                    .end_d1 = axes * held_d1(problem, end),
                    .turns = prescribed_turns(problem, first, end)};
}

constexpr const char* confined_requirement =
    "false unless grips, forces and natural curvature lie in one plane, at most one clamp has a "
    "frame, and there are no obstacles";

constexpr const char* couple_requirement =
    "0, or normal to the plane of grips and forces if the rod stays in it, at most one clamp has a "
    "frame, and there are no obstacles: any other couple has no potential";

/// Adds couples about the normal of the span's plane to the loads of the span.
void place_couples(const Problem& problem, const SpanInterval& stretch, PlacedSpan& placed) {
  const double unit = bending_unit(problem) / problem.length;
  for (const Load& load : problem.loads) {
    if (!stretch.contains(load.at) || load.torque.isZero(0) || clamp_at_load(problem, load))
      continue;
    const Eigen::Vector3d own = placed.frame * load.torque;
    require(placed.span.planar && own.head<2>().norm() <= direction_rounding * own.norm() &&
                clamps_with_frames(problem) < 2 && problem.obstacles.empty(),
            "Problem", "torque of a load", load.torque.norm(), couple_requirement);
    // The couple is added to the load without a couple that place_loads() has placed at s; couples
    // at one position add up.
    const double s = placed.s_of(load.at, problem.length);
    const auto at = std::ranges::find(placed.span.loads, s, &Span::Load::at);
    at->couple += own.z() / unit;
    const CoupleZero zero = couple_zero(problem, load);
    const Eigen::Vector3d direction = (placed.reversed ? -1 : 1) * (placed.frame * zero.direction);
    at->zero_at = std::clamp(placed.s_of(zero.at, problem.length), 0.0, placed.span.length);
    at->zero_angle = std::atan2(direction.y(), direction.x());
  }
}

/// Places the grips of the span by growing s; the first of them is its anchor.
void place_grips(const Problem& problem, const std::vector<OrderedGrip>& held,
                 const SpanInterval& stretch, PlacedSpan& placed, Directions& directions) {
  const double l = problem.length;
  const double sense = placed.reversed ? -1 : 1;
  Span& span = placed.span;
  const OrderedGrip& anchor = held.front();
  placed.anchor_grip = anchor.index;
  placed.anchor_position = anchor.grip->position;
  span.anchor = placed.s_of(anchor.grip->at, l);
  if (stretch.clamped_begin || stretch.clamped_end) {
    span.start_direction = sense * anchor.grip->direction->normalized();
    directions.grips.push_back(*span.start_direction);
  }
  for (std::size_t i = 1; i < held.size(); ++i) {
    const Eigen::Vector3d offset = (held[i].grip->position - placed.anchor_position) / l;
    span.holds.push_back({placed.s_of(held[i].grip->at, l), offset});
    placed.hold_grips.push_back(held[i].index);
    const bool at_end = stretch.is_between_clamps() && i + 1 == held.size();
    if (held[i].grip->direction && !at_end) {
      span.holds.back().direction = sense * held[i].grip->direction->normalized();
      directions.grips.push_back(*span.holds.back().direction);
    }
    if (offset.norm() > 1e-9) directions.grips.push_back(offset.normalized());
  }
  if (stretch.is_between_clamps()) {
    span.holds.back().at = span.length;
    span.end_direction = held.back().grip->direction->normalized();
    directions.grips.push_back(*span.end_direction);
  }
}

/// Places the loads that are not on clamps, and collects the directions of all forces.
void place_loads(const Problem& problem, const SpanInterval& stretch, PlacedSpan& placed,
                 Directions& directions) {
  const double l = problem.length;
  const double force_unit = bending_unit(problem) / (l * l);
  Span& span = placed.span;
  directions.forces.push_back(span.weight);
  for (const Span::Part& part : span.parts) directions.forces.push_back(part.weight);
  for (const LineLoad& load : span.line_loads) {
    directions.forces.insert(directions.forces.end(), {load.at_begin, load.at_end});
  }
  for (const Load& load : problem.loads) {
    // A load on a clamp is carried by the gripper alone.
    if (!stretch.contains(load.at) || clamp_at_load(problem, load)) continue;
    span.loads.push_back({placed.s_of(load.at, l), load.force / force_unit});
    directions.forces.push_back(span.loads.back().force);
    if (load.torque.isZero(0)) continue;
    for (const Eigen::Vector3d& direction : plane_across(load.torque)) {
      directions.grips.push_back(direction);
    }
  }
  std::ranges::sort(span.loads, {}, &Span::Load::at);
}

void place_obstacles(const Problem& problem, PlacedSpan& placed, Directions& directions) {
  const double l = problem.length;
  const double force_unit = bending_unit(problem) / (l * l);
  Span& span = placed.span;
  for (std::size_t i = 0; i < problem.obstacles.size(); ++i) {
    const Obstacle& obstacle = problem.obstacles[i];
    const Span::Obstacle placed_obstacle{
        i, obstacle.body.transformed(placed.anchor_position, Eigen::Matrix3d::Identity(), l)};
    if (std::isinf(obstacle.stiffness)) {
      span.rigid_obstacles.push_back(placed_obstacle);
    } else {
      span.soft_obstacles.push_back({placed_obstacle, obstacle.stiffness * l * l / force_unit});
    }
    if (obstacle.body.is_half_space()) directions.grips.push_back(obstacle.body.normal());
  }
}

/// Creates the span of an interval. It runs backwards if only its end is clamped.
PlacedSpan place(const Problem& problem, const std::vector<OrderedGrip>& grips,
                 const SpanInterval& stretch) {
  const double l = problem.length;
  const double force_unit = bending_unit(problem) / (l * l);
  PlacedSpan placed;
  placed.reversed = stretch.clamped_end && !stretch.clamped_begin;
  placed.start = placed.reversed ? stretch.end : stretch.begin;
  Span& span = placed.span;
  span.length = (stretch.end - stretch.begin) / l;
  span.weight = total_uniform_weight(problem) * l / force_unit;
  span.stiffness = principal_stiffness({.bending_stiffness = problem.bending_stiffness,
                                        .torsional_stiffness = problem.torsional_stiffness,
                                        .bending_stiffness_2 = problem.bending_stiffness_2},
                                       bending_unit(problem));
  place_sections(problem, stretch, placed);
  place_line_loads(problem, stretch, placed);
  std::vector<OrderedGrip> held;
  for (const OrderedGrip& g : grips) {
    if (stretch.contains(g.grip->at)) held.push_back(g);
  }
  if (placed.reversed) std::reverse(held.begin(), held.end());
  Directions directions;
  place_grips(problem, held, stretch, placed, directions);
  place_loads(problem, stretch, placed, directions);
  place_obstacles(problem, placed, directions);
  choose_frame(placed, directions);
  turn_vectors(span, placed.frame);
  if (has_couples(problem)) place_couples(problem, stretch, placed);
  if (!are_symmetric(span)) span.planar = false;
  if (has_material_directors(problem)) place_material_directors(problem, held.front(), placed);
  require(!span.has_couples() || span.planar, "Problem", "torque of a load", span.total_load(),
          couple_requirement);
  span.confined = problem.confined_to_plane;
  require(!span.confined ||
              (span.planar && clamps_with_frames(problem) < 2 && problem.obstacles.empty()),
          "Problem", "confined_to_plane", 1, confined_requirement);
  if (stretch.is_between_clamps()) {
    placed.frames = frames_of(problem, held.front(), *held.back().grip, placed.frame);
  }
  return placed;
}

/// Returns the arc lengths of the clamps that end spans. A clamp about which the rod rotates freely
/// transmits a torque; there is one between clamps that hold frames, and all along a rod with
/// material directors.
std::vector<double> cuts_at_clamps(const Problem& problem, const std::vector<OrderedGrip>& grips) {
  std::vector<OrderedGrip> clamps;
  for (const OrderedGrip& g : grips) {
    if (g.grip->direction) clamps.push_back(g);
  }
  const bool material = has_material_directors(problem);
  const auto holds = [](const OrderedGrip& g) { return g.grip->frame.has_value(); };
  const auto first = std::ranges::find_if(clamps, holds);
  const auto last = std::find_if(clamps.rbegin(), clamps.rend(), holds).base();
  std::vector<double> cuts;
  for (auto clamp = clamps.begin(); clamp != clamps.end(); ++clamp) {
    const bool between = clamp > first && clamp < last;
    const bool at_end = clamp + 1 == clamps.end() && clamp->grip->at == problem.length;
    const bool passes = material ? clamp != clamps.begin() && !at_end : between;
    if (holds(*clamp) || !passes) cuts.push_back(clamp->grip->at);
  }
  return cuts;
}

}  // namespace

std::vector<PlacedSpan> split(const Problem& problem) {
  check(problem);
  require_dead_loads(problem, "Problem");
  require_inextensible(problem, "Problem");
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  const std::vector<double> clamps = cuts_at_clamps(problem, grips);
  std::vector<PlacedSpan> spans;
  if (clamps.empty()) {
    return {place(problem, grips, {0, problem.length})};
  }
  const double shortest = same_arc_length_share * problem.length;
  if (clamps.front() > shortest) {
    spans.push_back(place(problem, grips, {0, clamps.front(), false, true}));
  }
  for (std::size_t i = 0; i + 1 < clamps.size(); ++i) {
    spans.push_back(place(problem, grips, {clamps[i], clamps[i + 1], true, true}));
  }
  if (problem.length - clamps.back() > shortest) {
    spans.push_back(place(problem, grips, {clamps.back(), problem.length, true}));
  }
  return spans;
}

}  // namespace dlo::energy_model
