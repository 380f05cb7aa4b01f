#include "split.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "dlo/energy_model/planar.hpp"
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
    const bool on_clamp = (clamped_begin && load.at == begin) || (clamped_end && load.at == end);
    if (!inside || on_clamp) continue;
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

Equilibrium assemble(const Problem& problem, const std::vector<PlacedSpan>& placed,
                     const std::vector<SpanSolution>& solutions) {
  const double l = problem.length;
  const double energy_unit = problem.bending_stiffness / l;
  const double force_unit = energy_unit / l;
  const Eigen::Vector3d origin = problem.grips.front().position;
  Equilibrium result;
  result.status = SolveStatus::converged;
  result.message = to_string(result.status);
  result.residual = 0;
  result.grips.resize(problem.grips.size());
  result.walls.assign(problem.walls.size(), Eigen::Vector3d::Zero());
  result.smallest_curvature = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const PlacedSpan& place = placed[i];
    const SpanSolution& solution = solutions[i];
    result.evaluations += solution.evaluations;
    result.terms = std::max(result.terms, solution.terms);
    result.residual = std::max(result.residual, solution.residual);
    result.smallest_curvature = std::min(result.smallest_curvature, solution.smallest_curvature);
    if (solution.status != SolveStatus::converged && succeeded(result.status)) {
      result.status = solution.status;
      result.message = solution.message;
    }
    if (solution.x.size() == 0) continue;
    const Energies own = solution.model->energies(solution.x);
    result.energy.bending += own.bending * energy_unit;
    const Eigen::Vector3d lift = place.anchor_position - origin;
    const Eigen::Vector3d weight = problem.weight_per_length * place.span.length * l;
    result.energy.gravity += own.gravity * energy_unit - weight.dot(lift);
    Eigen::Vector3d carried = place.frame * weight / force_unit;
    result.energy.load += own.load * energy_unit;
    for (const Span::Load& load : place.span.loads) {
      carried += load.force;
      result.energy.load -= force_unit * (place.frame.transpose() * load.force).dot(lift);
    }
    const std::vector<Eigen::Vector3d> walls = solution.model->wall_forces();
    for (std::size_t w = 0; w < walls.size(); ++w) {
      carried += walls[w];
      result.walls[w] += force_unit * (place.frame.transpose() * walls[w]);
    }
    const Eigen::Index axes = place.span.planar ? 2 : 3;
    for (std::size_t j = 0; j < place.hold_grips.size(); ++j) {
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      force.head(axes) = solution.multipliers.segment(static_cast<Eigen::Index>(j) * axes, axes);
      carried += force;
      result.grips[place.hold_grips[j]].force += force_unit * (place.frame.transpose() * force);
    }
    result.grips[place.anchor_grip].force -= force_unit * (place.frame.transpose() * carried);
    const auto to_space = [&](const Eigen::Vector3d& torque) {
      return Eigen::Vector3d(energy_unit * (place.frame.transpose() * torque));
    };
    result.grips[place.anchor_grip].torque +=
        to_space(solution.model->start_torque(solution.multipliers));
    if (place.span.end_direction) {
      result.grips[place.hold_grips.back()].torque +=
          to_space(solution.model->end_torque(solution.multipliers));
    }
  }
  for (const Load& load : problem.loads) {
    for (std::size_t g = 0; g < problem.grips.size(); ++g) {
      const Grip& grip = problem.grips[g];
      if (!grip.direction || grip.at != load.at) continue;
      result.grips[g].force -= load.force;
      result.energy.load -= load.force.dot(grip.position - origin);
      break;
    }
  }
  struct Piece {
    PlacedSpan place;
    std::shared_ptr<const SpanEnergy> model;
    Eigen::VectorXd x;
  };
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (solutions[i].x.size() > 0) {
      pieces.push_back({placed[i], solutions[i].model, solutions[i].x});
    }
  }
  result.sample = [l, pieces](std::span<const double> arc_lengths) {
    const auto count = static_cast<Eigen::Index>(arc_lengths.size());
    Samples samples;
    samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
    samples.points.resize(3, count);
    samples.tangents.resize(3, count);
    samples.curvature.resize(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double at = arc_lengths[static_cast<std::size_t>(i)];
      require(at >= 0 && at <= l, "sample", "arc length", at, "in [0, " + std::to_string(l) + "]");
      std::size_t p = 0;
      const auto ends = [&](const Piece& piece) {
        return piece.place.reversed ? piece.place.start
                                    : piece.place.start + piece.place.span.length * l;
      };
      while (p + 1 < pieces.size() && at > ends(pieces[p])) ++p;
      const Piece& piece = pieces[p];
      const SpanSamples own = piece.model->sample(piece.x, {piece.place.s_of(at, l)});
      const Eigen::Matrix3d back = piece.place.frame.transpose();
      samples.points.col(i) = piece.place.anchor_position + l * (back * own.points.col(0));
      samples.tangents.col(i) = (piece.place.reversed ? -1.0 : 1.0) * (back * own.tangents.col(0));
      samples.curvature.col(i) = back * own.curvature.col(0) / l;
    }
    return samples;
  };
  return result;
}

}  // namespace dlo::energy_model
