#include "touching/touching_cantilever.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "problem/reduction.hpp"
#include "touching/contact_shooting.hpp"

namespace dlo::energy_model {
namespace {

constexpr double out_of_plane = 1e-12;  // of a normal
// Growth of the fastest mode over one arc: e^6 keeps nine digits.
constexpr double growth_of_arc = 6;
constexpr double first_gamma = 1e-3;     // straight but for 1e-4 l
constexpr double smallest_ratio = 1e-4;  // of a step of ln(weight)
constexpr double allowed_depth = 1e-9;   // in l; a tenth of what a converged shape may have
constexpr double allowed_step = 1e-9;    // of Newton's last step

constexpr double stability_margin = 1e-3;  // of the rates of the second variation

double gap(const Floor& floor, const ArcState& state) {
  return floor.normal.x() * state[0] + floor.normal.y() * state[1] - floor.height;
}

/// Angle along a plane next to `angle`.
double angle_along(const Floor& floor, double angle) {
  const double plane = std::atan2(-floor.normal.x(), floor.normal.y());
  return plane + std::numbers::pi * std::round((angle - plane) / std::numbers::pi);
}

std::optional<std::vector<Floor>> floors_of(const Problem& problem, const Plane& plane) {
  std::vector<Floor> floors;
  for (const Obstacle& obstacle : problem.obstacles) {
    if (!obstacle.body.is_half_space() || std::isfinite(obstacle.stiffness)) return std::nullopt;
    const Eigen::Vector2d normal = plane.coordinates(obstacle.body.normal());
    if (std::abs(normal.norm() - 1) > out_of_plane) return std::nullopt;
    floors.push_back({normal, -obstacle.body.clearance(plane.origin) / problem.length});
  }
  return floors;
}

/// The shape under part of the weight and the obstacle that it touches.
struct Stage {
  TouchingShape shape;
  std::size_t floor = 0;
};

/// What the signs of gap, force and slope ask for, or nothing where they are as they have to be.
std::optional<Stage> with_other_contact(const Stage& stage, const std::vector<Floor>& floors) {
  Stage next = stage;
  TouchingShape& shape = next.shape;
  const ArcState end = state_at(shape, 1);
  if (shape.contact == EndContact::none) {
    double lowest = -allowed_depth;
    for (std::size_t k = 0; k < floors.size(); ++k) {
      if (gap(floors[k], end) >= lowest) continue;
      lowest = gap(floors[k], end);
      next.floor = k;
      shape.floor = floors[k];
      shape.contact = EndContact::tip;
    }
    if (shape.contact == EndContact::none) return std::nullopt;
    return next;
  }
  if (shape.force < 0) {
    if (shape.contact == EndContact::lying) return std::nullopt;  // lifts inside: not known here
    shape.contact = EndContact::none;
    shape.force = 0;
    return next;
  }
  const double rising = shape.floor.normal.dot(Eigen::Vector2d(std::cos(end[2]), std::sin(end[2])));
  if (shape.contact == EndContact::tip && rising > 1e-12) {
    shape.contact = EndContact::lying;
    shape.end_angle = angle_along(shape.floor, end[2]);
    return next;
  }
  if (shape.contact == EndContact::lying && shape.reach > 1) {
    shape.contact = EndContact::tip;
    shape.reach = 1;
    return next;
  }
  return std::nullopt;
}

/// Closed with the contact that its signs ask for.
bool settle(Stage& stage, const std::vector<Floor>& floors) {
  for (int changes = 0; changes < 4; ++changes) {
    if (!close_arcs(stage.shape)) return false;
    std::optional<Stage> other = with_other_contact(stage, floors);
    if (!other) return true;
    stage = *std::move(other);
  }
  return false;
}

/// The weight raised from nothing to all of it. @return how far it came, 1: to the end
double raise_weight(Stage& stage, const Eigen::Vector2d& weight, const std::vector<Floor>& floors,
                    const Deadline& deadline) {
  double share = std::min(1.0, first_gamma / weight.norm());
  double ratio = 0.3;
  stage.shape.weight = share * weight;
  if (!settle(stage, floors)) return 0;
  while (share < 1 && ratio > smallest_ratio && !deadline.passed()) {
    const double next = std::min(1.0, share * std::exp(ratio));
    Stage trial = stage;
    trial.shape.weight = next * weight;
    trial.shape.force *= next / share;
    const bool settled = settle(trial, floors);
    // An odd number of equilibria has been passed by: the branch is not followed any more.
    const bool same =
        trial.shape.contact != stage.shape.contact || trial.shape.positive == stage.shape.positive;
    if (!settled || !same) {
      ratio /= 2;
      continue;
    }
    stage = std::move(trial);
    share = next;
    ratio = std::min(0.5, 1.5 * ratio);
  }
  return share;
}

/// What is wrong with a closed shape; empty: nothing.
std::string objection(const Stage& stage, const std::vector<Floor>& floors, double depth) {
  const TouchingShape& shape = stage.shape;
  if (depth > allowed_depth) return "another part of the rod would touch, which is not known here";
  if (shape.contact != EndContact::none && shape.force < 0) return "an obstacle would have to pull";
  if (shape.contact == EndContact::lying && floors[stage.floor].normal.dot(shape.weight) > 0) {
    return "what lies would have to be pulled to the obstacle";
  }
  return shape.step < allowed_step ? "" : "Newton's last step was " + std::to_string(shape.step);
}

ContactPart contact_of(const Problem& problem, const Stage& stage) {
  const TouchingShape& shape = stage.shape;
  const double l = problem.length;
  const double unit = problem.bending_stiffness / (l * l);
  const bool lies = shape.contact == EndContact::lying;
  const double pressure = lies ? -shape.floor.normal.dot(shape.weight) : 0;
  ContactPart part;
  part.obstacle = stage.floor;
  part.kind = lies ? ContactKind::lying : ContactKind::tip;
  part.begin = l * shape.reach;
  part.end = l;
  part.force = unit * (shape.force + pressure * (1 - shape.reach)) *
               problem.obstacles[stage.floor].body.normal();
  part.begin_force = lies ? unit * shape.force : 0;
  part.largest_pressure = unit / l * pressure;
  return part;
}

/// Bending and gravity of the shape, and its largest depth.
struct Sums {
  double bending = 0;
  double gravity = 0;
  double depth = 0;
};

Sums sums_of(const TouchingShape& shape, const std::vector<Floor>& floors) {
  // Gauss-Legendre, eight points (Abramowitz and Stegun, table 25.4), a panel for each unit of
  // sqrt(w) s.
  static constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290,
                                                 0.7966664774136267, 0.9602898564975363};
  static constexpr std::array<double, 4> share = {0.3626837833783620, 0.3137066458778873,
                                                  0.2223810344533745, 0.1012285362903763};
  Sums sums;
  const auto add = [&](double s, double by) {
    const ArcState at = state_at(shape, s);
    sums.bending += by * at[3] * at[3] / 2;
    sums.gravity -= by * shape.weight.dot(Eigen::Vector2d(at[0], at[1]));
    for (const Floor& floor : floors) sums.depth = std::max(sums.depth, -gap(floor, at));
  };
  const int per_arc = static_cast<int>(growth_of_arc) + 2;
  const int panels = per_arc * static_cast<int>(shape.nodes.size());
  const double half = shape.reach / panels / 2;
  for (int p = 0; p < panels; ++p) {
    for (std::size_t k = 0; k < node.size(); ++k) {
      add((2 * p + 1 - node[k]) * half, half * share[k]);
      add((2 * p + 1 + node[k]) * half, half * share[k]);
    }
  }
  add(shape.reach, 0);
  if (shape.reach < 1) add((1 + shape.reach) / 2, 1 - shape.reach);
  add(1, 0);
  return sums;
}

Equilibrium assemble(const Problem& problem, const ReducedCantilever& reduced, const Stage& stage,
                     const std::vector<Floor>& floors) {
  const TouchingShape& shape = stage.shape;
  const Sums sums = sums_of(shape, floors);
  Equilibrium result;
  result.residual = shape.residual;
  result.evaluations = shape.shots;
  result.penetration = sums.depth * problem.length;
  const std::string wrong = objection(stage, floors, sums.depth);
  result.status = wrong.empty() ? SolveStatus::converged : SolveStatus::not_resolved;
  if (wrong.empty() && !is_stable(shape, stability_margin)) {
    result.status =
        is_stable(shape, -stability_margin) ? SolveStatus::near_singular : SolveStatus::saddle;
  }
  result.message = wrong.empty() ? to_string(result.status) : wrong;
  result.energy =
      restore(problem, Energies{.bending = sums.bending, .gravity = sums.gravity, .load = 0});
  result.obstacles.assign(problem.obstacles.size(), Eigen::Vector3d::Zero());
  result.grips = {clamp_reaction(problem, reduced, shape.nodes.front()[3])};
  if (shape.contact != EndContact::none) {
    result.contacts = {contact_of(problem, stage)};
    result.obstacles[stage.floor] = result.contacts.front().force;
    result.grips.front().force -= result.contacts.front().force;
  }
  result.sample = [problem, reduced, shape](std::span<const double> arc_lengths) {
    const std::vector<double> at = distances_from_clamp(problem, false, arc_lengths);
    PlanarSamples planar(static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i) {
      const ArcState state = state_at(shape, at[i]);
      const auto column = static_cast<Eigen::Index>(i);
      planar.points.col(column) << state[0], state[1];
      planar.angle[column] = state[2];
      planar.curvature[column] = state[3];
    }
    return restore(problem, reduced, arc_lengths, planar);
  };
  return result;
}

}  // namespace

std::optional<Equilibrium> solve_touching_cantilever(const Problem& problem,
                                                     const Deadline& deadline) {
  const std::optional<ReducedCantilever> reduced = reduce_cantilever(problem);
  const bool plain = problem.sections.empty() && problem.loads.empty() &&
                     !has_material_directors(problem) && !problem.grips.front().frame;
  if (!reduced || reduced->reversed || !plain) return std::nullopt;
  const Eigen::Vector2d weight = reduced->rod.weight;
  const std::optional<std::vector<Floor>> floors = floors_of(problem, reduced->plane);
  if (!floors || !(weight.norm() > first_gamma)) return std::nullopt;

  Stage stage;
  const auto arcs = static_cast<std::size_t>(4 + std::sqrt(weight.norm()) / growth_of_arc);
  for (std::size_t i = 0; i < arcs; ++i) {
    stage.shape.nodes.push_back({static_cast<double>(i) / static_cast<double>(arcs), 0, 0, 0});
  }
  const double share = raise_weight(stage, weight, *floors, deadline);
  if (share < 1) {
    Equilibrium result;
    result.status = deadline.passed() ? SolveStatus::time_limit : SolveStatus::failed;
    result.message = "the end's contact could be followed up to " + std::to_string(share) +
                     " of the weight: beyond it folds or another part of the rod touches";
    return result;
  }
  return assemble(problem, *reduced, stage, *floors);
}

}  // namespace dlo::energy_model
