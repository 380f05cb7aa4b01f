#include "split.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

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

double closest_approach(const Eigen::Vector3d& axis, const std::vector<Eigen::Vector3d>& vectors) {
  double closest = 0;
  for (const Eigen::Vector3d& v : vectors) closest = std::max(closest, std::abs(axis.dot(v)));
  return closest;
}

/// Points that cover a half sphere evenly.
std::vector<Eigen::Vector3d> sphere_directions() {
  constexpr int count = 400;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

Eigen::Matrix3d frame_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& towards) {
  Eigen::Vector3d x = towards - towards.dot(axis) * axis;
  x = x.norm() > 1e-6 ? x.normalized() : axis.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << x.transpose(), axis.cross(x).transpose(), axis.transpose();
  return frame;
}

/// The axis of a spatial span: as far as can be from all that its tangents may run along.
Eigen::Matrix3d spatial_frame(const Directions& directions) {
  std::vector<Eigen::Vector3d> vectors = directions.grips;
  for (const Eigen::Vector3d& force : directions.forces) {
    if (force.norm() > 0) vectors.push_back(force.normalized());
  }
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double least = 2;
  for (const Eigen::Vector3d& axis : sphere_directions()) {
    const double approach = closest_approach(axis, vectors);
    if (approach < least) {
      least = approach;
      best = axis;
    }
  }
  return frame_about(best, vectors.empty() ? Eigen::Vector3d::UnitX().eval() : vectors.front());
}

void choose_frame(PlacedSpan& placed, const Directions& directions) {
  // find_plane wants the first direction and everything else; a direction and a force count alike.
  Eigen::Vector3d first = Eigen::Vector3d::UnitX();
  std::vector<Eigen::Vector3d> others;
  double largest = 0;
  for (const Eigen::Vector3d& force : directions.forces) largest = std::max(largest, force.norm());
  for (const Eigen::Vector3d& force : directions.forces) {
    if (largest > 0) others.emplace_back(force / largest);
  }
  others.insert(others.end(), directions.grips.begin(), directions.grips.end());
  if (!directions.grips.empty()) {
    first = directions.grips.front();
  } else if (largest > 0) {
    first = others.front();
  }
  const std::optional<Plane> plane = find_plane(Eigen::Vector3d::Zero(), first, others);
  placed.span.planar = plane.has_value();
  if (plane) {
    placed.frame << plane->x.transpose(), plane->y.transpose(),
        plane->x.cross(plane->y).transpose();
  } else {
    placed.frame = spatial_frame(directions);
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

void turn_axis(PlacedSpan& placed, const Eigen::Matrix3Xd& tangents) {
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double least = 2;
  for (const Eigen::Vector3d& axis : sphere_directions()) {
    const double approach = (axis.transpose() * tangents).cwiseAbs().maxCoeff();
    if (approach < least) {
      least = approach;
      best = axis;
    }
  }
  const Eigen::Matrix3d rotation = frame_about(best, tangents.col(0));
  placed.frame = (rotation * placed.frame).eval();
  turn_vectors(placed.span, rotation);
}

}  // namespace dlo::energy_model
