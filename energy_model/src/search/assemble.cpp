#include "search/assemble.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/zero_modes_note.hpp"
#include "problem/ordered_grips.hpp"
#include "problem/reduction.hpp"
#include "problem/rod_law.hpp"
#include "search/placed_shape.hpp"

namespace dlo::energy_model {
namespace {

/// With arc lengths in m, forces in the span's unit.
std::vector<ContactPart> contacts_of(const PlacedSpan& place, const SpanSolution& solution,
                                     double length) {
  std::vector<ContactPart> parts;
  const Span& span = solution.model->span();
  if (span.contacts.empty()) return parts;
  const std::vector<ContactForce> forces = solution.model->contact_forces(solution.multipliers);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Span::Contact& contact = span.contacts[i];
    const double sense = place.reversed ? -length : length;
    ContactPart part;
    part.obstacle = contact.obstacle.index;
    const bool at_tip = contact.end == span.length && !span.end_direction;
    part.kind = contact.lies()                 ? ContactKind::lying
                : at_tip || contact.begin == 0 ? ContactKind::tip
                                               : ContactKind::touching;
    part.begin = place.start + sense * contact.begin;
    part.end = place.start + sense * contact.end;
    part.force = place.frame.transpose() * forces[i].force;
    part.begin_force = contact.lies() ? forces[i].begin : 0;
    part.end_force = forces[i].end;
    part.largest_pressure = forces[i].largest_pressure;
    if (place.reversed) {
      std::swap(part.begin, part.end);
      std::swap(part.begin_force, part.end_force);
    }
    parts.push_back(part);
  }
  return parts;
}

ContactPart in_newtons(ContactPart part, double force_unit, double length) {
  part.force *= force_unit;
  part.begin_force *= force_unit;
  part.end_force *= force_unit;
  part.largest_pressure *= force_unit / length;
  return part;
}

/// Whether less is claimed of a shape by one status than by another: that it is no equilibrium at
/// all outweighs what kind of one it is.
bool is_worse(SolveStatus status, SolveStatus than) {
  const auto rank = [](SolveStatus s) {
    if (s == SolveStatus::converged) return 0;
    if (s == SolveStatus::roundoff_limited) return 1;
    return s == SolveStatus::saddle || s == SolveStatus::near_singular ? 2 : 3;
  };
  return rank(status) > rank(than);
}

}  // namespace

Equilibrium assemble(const Problem& problem, const std::vector<PlacedSpan>& placed,
                     const std::vector<const SpanSolution*>& solutions) {
  const double l = problem.length;
  const double energy_unit = bending_unit(problem) / l;
  const double force_unit = energy_unit / l;
  const Eigen::Vector3d origin = problem.grips.front().position;
  Equilibrium result;
  result.status = SolveStatus::converged;
  result.message = to_string(result.status);
  result.residual = 0;
  result.error_estimate = 0;
  result.grips.resize(problem.grips.size());
  result.obstacles.assign(problem.obstacles.size(), Eigen::Vector3d::Zero());
  result.smallest_eigenvalue = std::numeric_limits<double>::infinity();
  int rigid_body_modes = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const PlacedSpan& place = placed[i];
    const SpanSolution& solution = *solutions[i];
    result.evaluations += solution.evaluations;
    result.terms = std::max(result.terms, solution.terms);
    // -1, where one is not known, stays.
    const bool known = solution.residual >= 0 && result.residual >= 0;
    result.residual = known ? std::max(result.residual, solution.residual) : -1;
    result.neutral_directions += solution.neutral_directions;
    rigid_body_modes += solution.rigid_body_modes;
    // NaN, where one is not known, stays.
    if (std::isnan(solution.error) || solution.error > result.error_estimate) {
      result.error_estimate = solution.error;
    }
    // NaN, where one was not looked at, stays.
    if (std::isnan(solution.smallest_eigenvalue) ||
        solution.smallest_eigenvalue < result.smallest_eigenvalue) {
      result.smallest_eigenvalue = solution.smallest_eigenvalue;
    }
    if (is_worse(solution.status, result.status)) {
      result.status = solution.status;
      result.message = solution.message;
    }
    if (solution.x.size() == 0) continue;
    const Energies own = solution.model->energies(solution.x);
    result.energy.bending += own.bending * energy_unit;
    result.energy.twisting += own.twisting * energy_unit;
    if (solution.model->span().twist) {
      result.twists.push_back(
          {place.start, place.start + place.span.length * l, solution.model->twist(solution.x),
           energy_unit * solution.model->twisting_torque(solution.x, solution.multipliers)});
    }
    const Eigen::Vector3d lift = place.anchor_position - origin;
    Eigen::Vector3d carried = place.span.weight_between(0, place.span.length);
    const Eigen::Vector3d weight = force_unit * (place.frame.transpose() * carried);
    result.energy.gravity += own.gravity * energy_unit - weight.dot(lift);
    result.energy.load += own.load * energy_unit;
    result.energy.contact += own.contact * energy_unit;
    for (const Span::Load& load : place.span.loads) {
      carried += load.force;
      result.energy.load -= force_unit * (place.frame.transpose() * load.force).dot(lift);
    }
    const std::vector<Eigen::Vector3d> obstacles = solution.model->soft_contact().forces();
    for (std::size_t w = 0; w < obstacles.size(); ++w) {
      carried += obstacles[w];
      result.obstacles[place.span.soft_obstacles[w].index] +=
          force_unit * (place.frame.transpose() * obstacles[w]);
    }
    for (const ContactPart& contact : contacts_of(place, solution, l)) {
      carried += place.frame * contact.force;
      result.obstacles[contact.obstacle] += force_unit * contact.force;
      result.contacts.push_back(in_newtons(contact, force_unit, l));
    }
    const Eigen::Index axes = solution.model->span().planar ? 2 : 3;
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
    for (std::size_t j = 0; j < place.hold_grips.size(); ++j) {
      result.grips[place.hold_grips[j]].torque +=
          to_space(solution.model->hold_torque(static_cast<Eigen::Index>(j), solution.multipliers));
    }
  }
  if (succeeded(result.status) || result.status == SolveStatus::saddle) {
    result.message += zero_modes_note(rigid_body_modes);
    if (has_couples(problem)) result.message += in_the_plane;
  }
  if (result.status == SolveStatus::near_singular && result.neutral_directions > 0) {
    result.message += ": " + std::to_string(result.neutral_directions) + " neutral direction" +
                      (result.neutral_directions == 1 ? "" : "s");
  }
  std::sort(result.contacts.begin(), result.contacts.end(),
            [](const ContactPart& a, const ContactPart& b) { return a.begin < b.begin; });
  for (const Load& load : problem.loads) {
    const std::optional<std::size_t> clamp = clamp_under(problem, load);
    if (!clamp) continue;
    result.grips[*clamp].force -= load.force;
    result.grips[*clamp].torque -= load.torque;
    result.energy.load -= load.force.dot(problem.grips[*clamp].position - origin);
  }
  std::vector<PlacedShape> shapes;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (solutions[i]->x.size() == 0) continue;
    const PlacedSpan& place = placed[i];
    shapes.push_back(placed_shape(place, *solutions[i], l));
    if (place.span.has_material_directors()) {
      shapes.back().ahead = [ahead = place.ahead](double) { return ahead; };
    }
  }
  const bool is_whole = shapes.size() == placed.size();
  if (is_whole && !has_material_directors(problem)) {
    place_twisted_material(problem, solutions, shapes);
  }
  result.sample = [l, shapes = std::move(shapes)](std::span<const double> arc_lengths) {
    return sample(shapes, l, arc_lengths);
  };
  if (is_whole) separate_line_loads(problem, result);
  return result;
}

}  // namespace dlo::energy_model
