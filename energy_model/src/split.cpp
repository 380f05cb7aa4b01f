#include "split.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dlo/energy_model/plane.hpp"
#include "ordered_grips.hpp"
#include "require.hpp"

namespace dlo::energy_model {
namespace {

/// What a span's frame has to reckon with: directions of grips, chords and forces, in space.
struct Directions {
  std::vector<Eigen::Vector3d> grips;
  std::vector<Eigen::Vector3d> forces;
};

void choose_frame(PlacedSpan& placed, const Directions& directions) {
  // find_plane wants the first direction and everything else; a direction and a force count alike.
  Eigen::Vector3d first = Eigen::Vector3d::UnitX();
  std::vector<Eigen::Vector3d> others;
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
    placed.frame << plane->x.transpose(), plane->y.transpose(),
        plane->x.cross(plane->y).transpose();
  } else {
    // Any will do; a rod that nothing clamps starts near to this x.
    const Eigen::Vector3d across = first.unitOrthogonal();
    placed.frame << first.transpose(), across.transpose(), first.cross(across).transpose();
  }
}

void turn_vectors(Span& span, const Eigen::Matrix3d& rotation) {
  const auto turn = [&](Eigen::Vector3d& v) { v = (rotation * v).eval(); };
  if (span.start_direction) turn(*span.start_direction);
  if (span.end_direction) turn(*span.end_direction);
  for (Span::Hold& hold : span.holds) turn(hold.offset);
  for (Span::Load& load : span.loads) turn(load.force);
  for (Span::Wall& wall : span.walls) turn(wall.normal);
  turn(span.weight);
}

/// What two clamps do with the rod's frame between them, seen in a span's own axes.
std::optional<HeldFrames> frames_of(const Problem& problem, const Grip& start, const Grip& end,
                                    const Eigen::Matrix3d& axes) {
  if (!start.frame || !end.frame) return std::nullopt;
  HeldFrames frames;
  frames.stiffness = problem.torsional_stiffness / problem.bending_stiffness;
  frames.roll = end.frame->roll - start.frame->roll;
  if (start.frame->d1) frames.start_d1 = axes * *start.frame->d1;
  if (end.frame->d1) frames.end_d1 = axes * *end.frame->d1;
  return frames;
}

/// The span between arc lengths `begin` and `end`; it runs backwards from a clamp at `end` if there
/// is none at `begin`.
PlacedSpan place(const Problem& problem, const std::vector<OrderedGrip>& grips, double begin,
                 double end, bool clamped_begin, bool clamped_end) {
  const double l = problem.length;
  const double force_unit = problem.bending_stiffness / (l * l);
  PlacedSpan placed;
  placed.reversed = clamped_end && !clamped_begin;
  placed.start = placed.reversed ? end : begin;
  Span& span = placed.span;
  span.length = (end - begin) / l;
  span.weight = problem.weight_per_length * l / force_unit;
  const double sense = placed.reversed ? -1 : 1;

  std::vector<OrderedGrip> held;
  for (const OrderedGrip& g : grips) {
    if (g.grip->at >= begin && g.grip->at <= end) held.push_back(g);
  }
  if (placed.reversed) std::reverse(held.begin(), held.end());
  const OrderedGrip& anchor = held.front();
  placed.anchor_grip = anchor.index;
  placed.anchor_position = anchor.grip->position;
  span.anchor = placed.s_of(anchor.grip->at, l);
  Directions directions;
  if (clamped_begin || clamped_end) {
    span.start_direction = sense * anchor.grip->direction->normalized();
    directions.grips.push_back(*span.start_direction);
  }
  for (std::size_t i = 1; i < held.size(); ++i) {
    const Eigen::Vector3d offset = (held[i].grip->position - placed.anchor_position) / l;
    span.holds.push_back({placed.s_of(held[i].grip->at, l), offset});
    placed.hold_grips.push_back(held[i].index);
    if (offset.norm() > 1e-9) directions.grips.push_back(offset.normalized());
  }
  if (clamped_begin && clamped_end) {
    span.holds.back().at = span.length;
    span.end_direction = held.back().grip->direction->normalized();
    directions.grips.push_back(*span.end_direction);
  }
  directions.forces.push_back(span.weight);
  for (const Load& load : problem.loads) {
    const bool inside = load.at >= begin && load.at <= end;
    // A load on a clamp is the gripper's alone.
    if (!inside || clamp_under(problem, load)) continue;
    span.loads.push_back({placed.s_of(load.at, l), load.force / force_unit});
    directions.forces.push_back(span.loads.back().force);
  }
  std::sort(span.loads.begin(), span.loads.end(),
            [](const Span::Load& a, const Span::Load& b) { return a.at < b.at; });
  for (const Wall& wall : problem.walls) {
    const Eigen::Vector3d normal = wall.normal.normalized();
    span.walls.push_back({normal, normal.dot(placed.anchor_position - wall.point) / l,
                          wall.stiffness * l * l / force_unit});
    directions.grips.push_back(normal);
  }
  choose_frame(placed, directions);
  turn_vectors(span, placed.frame);
  if (clamped_begin && clamped_end) {
    placed.frames = frames_of(problem, *held.front().grip, *held.back().grip, placed.frame);
  }
  return placed;
}

}  // namespace

std::vector<PlacedSpan> split(const Problem& problem) {
  check(problem);
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  std::vector<double> clamps;
  for (const OrderedGrip& g : grips) {
    if (g.grip->direction) clamps.push_back(g.grip->at);
  }
  std::vector<PlacedSpan> spans;
  if (clamps.empty()) {
    return {place(problem, grips, 0, problem.length, false, false)};
  }
  const double shortest = 1e-9 * problem.length;
  if (clamps.front() > shortest) {
    spans.push_back(place(problem, grips, 0, clamps.front(), false, true));
  }
  for (std::size_t i = 0; i + 1 < clamps.size(); ++i) {
    spans.push_back(place(problem, grips, clamps[i], clamps[i + 1], true, true));
  }
  if (problem.length - clamps.back() > shortest) {
    spans.push_back(place(problem, grips, clamps.back(), problem.length, true, false));
  }
  return spans;
}

}  // namespace dlo::energy_model
