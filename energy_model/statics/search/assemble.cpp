#include "search/assemble.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/found_equilibria.hpp"
#include "base/sized_samples.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Tangent and material d1 of a shape at an arc length, in space.
struct MaterialFrame {
  Eigen::Vector3d tangent, d1;
};

MaterialFrame material_at(const PlacedShape& shape, double length, double arc_length) {
  const Samples samples = sample({shape}, length, std::array{arc_length});
  return {samples.tangents.col(0), samples.d1.col(0)};
}

/// Rotates the material of a shape so that it has this d1 at an arc length.
void rotate_material(PlacedShape& shape, double length, double arc_length,
                     const Eigen::Vector3d& d1) {
  const MaterialFrame here = material_at(shape, length, arc_length);
  const double sense = shape.reversed ? -1 : 1;
  const double by = sense * std::atan2(here.tangent.dot(here.d1.cross(d1)), here.d1.dot(d1));
  shape.ahead = [by, before = std::move(shape.ahead)](double s) { return by + before(s); };
}

/// Returns d1 of the frame that the grip at an arc length prescribes; there must be such a grip.
Eigen::Vector3d first_d1(const Problem& problem, double arc_length) {
  const auto grip = std::ranges::find_if(problem.grips, [&](const Grip& each) {
    return each.frame && std::abs(each.at - arc_length) <= same_arc_length_share * problem.length;
  });
  return held_frame(*grip, held_d1(problem, *grip)).col(0);
}

/// Sets `ahead` for the shapes of a round straight rod that clamps twist. The torque is constant
/// along a twisted span and rotates the material in proportion to the compliance 1 / GJ. Adjacent
/// spans are not twisted, and their material continues that of the twisted span. Does nothing if no
/// span is twisted.
/// @param shapes, solutions  of all spans, by ascending arc length
void place_twisted_material(const Problem& problem,
                            const std::vector<const SpanSolution*>& solutions,
                            std::vector<PlacedShape>& shapes) {
  const auto is_twisted = [](const SpanSolution* solution) {
    return solution->model->span().twist.has_value();
  };
  const auto first = std::ranges::find_if(solutions, is_twisted);
  if (first == solutions.end()) return;
  const double l = problem.length;
  const std::vector<RodPart> parts = rod_parts(problem);
  std::vector<double> begins;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    begins.push_back(i == 0 ? 0 : shapes[i - 1].end);
    shapes[i].ahead = [](double) { return 0.0; };
    if (!is_twisted(solutions[i])) continue;
    const double rate = solutions[i]->model->twist(solutions[i]->x) /
                        torsional_compliance(parts, begins[i], shapes[i].end);
    shapes[i].ahead = [parts, rate, begin = begins[i], l](double s) {
      return rate * torsional_compliance(parts, begin, begin + s * l);
    };
  }
  const auto held = static_cast<std::size_t>(first - solutions.begin());
  rotate_material(shapes[held], l, begins[held], first_d1(problem, begins[held]));
  for (std::size_t i = held + 1; i < shapes.size(); ++i) {
    rotate_material(shapes[i], l, begins[i], material_at(shapes[i - 1], l, begins[i]).d1);
  }
  for (std::size_t i = held; i-- > 0;) {
    rotate_material(shapes[i], l, shapes[i].end, material_at(shapes[i + 1], l, shapes[i].end).d1);
  }
}

/// Force of a contact's multipliers on a grip at the contact's begin or end.
struct GripContactForce {
  std::size_t contact = 0;
  double s = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // about the anchor
};

std::vector<GripContactForce> grip_contact_forces(const SpanSolution& solution,
                                                  const std::vector<ContactForce>& forces) {
  std::vector<GripContactForce> held;
  const SpanShape shape = solution.model->shape(solution.x);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Span::Contact& contact = solution.model->span().contacts[i];
    const auto add = [&](double s, double size) {
      if (size == 0) return;
      const Eigen::Vector3d r = shape.sample(std::array{s}).points.col(0);
      const Eigen::Vector3d force = size * contact.obstacle.body.gap(r).gradient;
      held.push_back({i, s, force, r.cross(force)});
    };
    add(contact.begin, forces[i].held_begin);
    add(contact.end, forces[i].held_end);
  }
  return held;
}

/// Returns the contacts of a span, with arc lengths in m, and forces and moments in the span's
/// units and the axes of space.
std::vector<ContactPart> contacts_of(const PlacedSpan& place, const SpanSolution& solution,
                                     const std::vector<ContactForce>& forces, double length) {
  std::vector<ContactPart> parts;
  const Span& span = solution.model->span();
  if (span.contacts.empty()) return parts;
  const std::shared_ptr<SpanPoint> at = solution.at_x();
  const SpanShape shape = solution.model->shape(solution.x);
  const std::vector<GripContactForce> held = grip_contact_forces(solution, forces);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Span::Contact& contact = span.contacts[i];
    const double sense = place.reversed ? -length : length;
    ContactPart part;
    part.obstacle = contact.obstacle.index;
    const bool at_tip = contact.end == span.length && !span.end_direction;
    part.kind = contact.lies()                 ? ContactKind::lying
                : at_tip || contact.begin == 0 ? ContactKind::tip
                                               : ContactKind::touching;
    // A sliding contact point is at the smallest clearance.
    const std::optional<double> touch = solution.model->contact_arc_length(*at, i);
    part.begin = place.start + sense * touch.value_or(contact.begin);
    part.end = place.start + sense * touch.value_or(contact.end);
    part.force = place.frame.transpose() * forces[i].force;
    part.begin_force = contact.lies() ? forces[i].begin : 0;
    part.end_force = forces[i].end;
    part.largest_pressure = forces[i].largest_pressure;
    if (contact.lies()) {
      const double first = place.reversed ? contact.end : contact.begin;
      const Eigen::Vector3d arm = shape.sample(std::array{first}).points.col(0);
      Eigen::Vector3d moment = forces[i].moment - arm.cross(forces[i].force);
      for (const GripContactForce& end : held) {
        if (end.contact == i) moment -= end.moment;
      }
      part.moment = place.frame.transpose() * moment;
    }
    if (place.reversed) {
      std::swap(part.begin, part.end);
      std::swap(part.begin_force, part.end_force);
    }
    parts.push_back(part);
  }
  return parts;
}

/// Whether one status claims less than another. The distinction between equilibria and other shapes
/// precedes that between kinds of equilibria.
bool is_worse(SolveStatus status, SolveStatus than) {
  const auto rank = [](SolveStatus s) {
    if (s == SolveStatus::converged) return 0;
    if (s == SolveStatus::roundoff_limited) return 1;
    return s == SolveStatus::saddle || s == SolveStatus::near_singular ? 2 : 3;
  };
  return rank(status) > rank(than);
}

/// Accumulates an equilibrium span by span.
class Assembly {
 public:
  explicit Assembly(const Problem& problem)
      : problem_(problem),
        l_(problem.length),
        energy_unit_(bending_unit(problem) / l_),
        force_unit_(energy_unit_ / l_) {
    result_.status = SolveStatus::converged;
    result_.message = to_string(result_.status);
    result_.residual = 0;
    result_.error_estimate = 0;
    result_.grips.resize(problem.grips.size());
    result_.obstacles.assign(problem.obstacles.size(), Eigen::Vector3d::Zero());
    result_.smallest_eigenvalue = std::numeric_limits<double>::infinity();
  }

  void add(const PlacedSpan& place, const SpanSolution& solution) {
    combine_status(solution);
    if (solution.x.size() == 0) return;
    add_energies(place, solution);
    add_reactions(place, solution);
  }

  Equilibrium finish(const std::vector<PlacedSpan>& placed,
                     const std::vector<const SpanSolution*>& solutions) {
    if (succeeded(result_.status) || result_.status == SolveStatus::saddle) {
      result_.message += zero_modes_note(rigid_body_modes_);
      if (has_couples(problem_)) result_.message += planar_check_note;
    }
    if (result_.status == SolveStatus::near_singular && result_.neutral_directions > 0) {
      result_.message += ": " + std::to_string(result_.neutral_directions) + " neutral direction" +
                         (result_.neutral_directions == 1 ? "" : "s");
    }
    std::ranges::sort(result_.contacts, {}, &ContactPart::begin);
    add_loads_on_clamps(problem_, result_);
    place_shapes(placed, solutions);
    return std::move(result_);
  }

 private:
  /// Combines the claims of the spans: the weakest claim holds for the whole rod.
  void combine_status(const SpanSolution& solution) {
    result_.evaluations += solution.evaluations;
    result_.terms = std::max(result_.terms, solution.terms);
    // -1 (unknown) is kept.
    const bool known = solution.residual >= 0 && result_.residual >= 0;
    result_.residual = known ? std::max(result_.residual, solution.residual) : -1;
    result_.neutral_directions += solution.neutral_directions;
    rigid_body_modes_ += solution.rigid_body_modes;
    // NaN (unknown) is kept.
    if (std::isnan(solution.error) || solution.error > result_.error_estimate) {
      result_.error_estimate = solution.error;
    }
    // NaN (not computed) is kept.
    if (std::isnan(solution.smallest_eigenvalue) ||
        solution.smallest_eigenvalue < result_.smallest_eigenvalue) {
      result_.smallest_eigenvalue = solution.smallest_eigenvalue;
    }
    if (is_worse(solution.status, result_.status)) {
      result_.status = solution.status;
      result_.message = solution.message;
    }
  }

  void add_energies(const PlacedSpan& place, const SpanSolution& solution) {
    const Energies own = solution.model->energies(*solution.at_x());
    Energies& sum = result_.energy;
    sum.bending += own.bending * energy_unit_;
    sum.twisting += own.twisting * energy_unit_;
    if (solution.model->span().twist) {
      result_.twists.push_back(
          {place.start, place.start + place.span.length * l_, solution.model->twist(solution.x),
           energy_unit_ * solution.model->twisting_torque(solution.x, solution.multipliers)});
    }
    // A span's potential is relative to its anchor.
    const Eigen::Vector3d lift = place.anchor_position - problem_.grips.front().position;
    const Eigen::Vector3d weight = to_newtons(place, weight_of(place));
    sum.gravity += own.gravity * energy_unit_ - weight.dot(lift);
    sum.load += own.load * energy_unit_;
    sum.contact += own.contact * energy_unit_;
    for (const Span::Load& load : place.span.loads) {
      sum.load -= to_newtons(place, load.force).dot(lift);
    }
  }

  void add_reactions(const PlacedSpan& place, const SpanSolution& solution) {
    const SpanEnergy& model = *solution.model;
    const std::shared_ptr<SpanPoint> at = solution.at_x();
    // Everything that no other grip carries acts on the anchor.
    Eigen::Vector3d carried = weight_of(place);
    for (const Span::Load& load : place.span.loads) carried += load.force;
    const std::vector<Eigen::Vector3d> obstacles = model.soft_obstacle_forces(*at);
    for (std::size_t w = 0; w < obstacles.size(); ++w) {
      carried += obstacles[w];
      result_.obstacles[place.span.soft_obstacles[w].index] += to_newtons(place, obstacles[w]);
    }
    const std::vector<ContactForce> pushes = model.contact_forces(*at, solution.multipliers);
    for (ContactPart& contact : contacts_of(place, solution, pushes, l_)) {
      carried += place.frame * contact.force;
      contact.force *= force_unit_;
      contact.moment *= force_unit_ * l_;
      contact.begin_force *= force_unit_;
      contact.end_force *= force_unit_;
      contact.largest_pressure *= force_unit_ / l_;
      result_.obstacles[contact.obstacle] += contact.force;
      result_.contacts.push_back(contact);
    }
    const Eigen::Index axes = model.span().planar ? 2 : 3;
    const auto to_space = [&](const Eigen::Vector3d& torque) {
      return Eigen::Vector3d(energy_unit_ * (place.frame.transpose() * torque));
    };
    Reaction& anchor = result_.grips[place.anchor_grip];
    anchor.torque += to_space(model.start_torque(*at, solution.multipliers));
    for (std::size_t j = 0; j < place.hold_grips.size(); ++j) {
      const auto hold = static_cast<Eigen::Index>(j);
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      force.head(axes) = solution.multipliers.segment(hold * axes, axes);
      carried += force;
      Reaction& own = result_.grips[place.hold_grips[j]];
      own.force += to_newtons(place, force);
      own.torque += to_space(model.hold_torque(*at, hold, solution.multipliers));
    }
    for (const GripContactForce& end : grip_contact_forces(solution, pushes)) {
      carried += add_force_to_grip(place, end.s, end.force);
    }
    anchor.force -= to_newtons(place, carried);
  }

  /// Adds a force to the grip at s. @return the force; zero if only the anchor is there
  [[nodiscard]] Eigen::Vector3d add_force_to_grip(const PlacedSpan& place, double s,
                                                  const Eigen::Vector3d& force) {
    for (std::size_t j = 0; j < place.hold_grips.size(); ++j) {
      if (std::abs(place.span.holds[j].at - s) > closest_cuts) continue;
      result_.grips[place.hold_grips[j]].force += to_newtons(place, force);
      return force;
    }
    return Eigen::Vector3d::Zero();
  }

  void place_shapes(const std::vector<PlacedSpan>& placed,
                    const std::vector<const SpanSolution*>& solutions) {
    std::vector<PlacedShape> shapes;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (solutions[i]->x.size() == 0) continue;
      const PlacedSpan& place = placed[i];
      const double end = place.reversed ? place.start : place.start + place.span.length * l_;
      shapes.push_back({solutions[i]->model->shape(solutions[i]->x),
                        place.reversed,
                        place.start,
                        end,
                        place.frame.transpose(),
                        place.anchor_position,
                        {}});
      if (place.span.has_material_directors()) {
        shapes.back().ahead = [ahead = place.ahead](double) { return ahead; };
      }
    }
    const bool is_whole = shapes.size() == placed.size();
    if (is_whole && !has_material_directors(problem_)) {
      place_twisted_material(problem_, solutions, shapes);
    }
    result_.sample = [l = l_, shapes = std::move(shapes)](std::span<const double> arc_lengths) {
      return sample(shapes, l, arc_lengths);
    };
    if (is_whole) separate_line_loads(problem_, result_);
  }

  /// Converts from the span's units and axes.
  [[nodiscard]] Eigen::Vector3d to_newtons(const PlacedSpan& place,
                                           const Eigen::Vector3d& force) const {
    return force_unit_ * (place.frame.transpose() * force);
  }
  [[nodiscard]] static Eigen::Vector3d weight_of(const PlacedSpan& place) {
    return place.span.weight_between(0, place.span.length);
  }

  const Problem& problem_;
  double l_, energy_unit_, force_unit_;
  int rigid_body_modes_ = 0;
  Equilibrium result_;
};

}  // namespace

Samples sample(const std::vector<PlacedShape>& shapes, double length,
               std::span<const double> arc_lengths) {
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  Samples samples = sized_samples(arc_lengths, length);
  if (!shapes.empty() && shapes.front().ahead) samples.d1.resize(3, count);
  std::vector<std::vector<Eigen::Index>> columns(shapes.size());
  std::vector<std::vector<double>> own_s(shapes.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = arc_lengths[static_cast<std::size_t>(i)];
    std::size_t p = 0;
    while (p + 1 < shapes.size() && at > shapes[p].end) ++p;
    columns[p].push_back(i);
    own_s[p].push_back((shapes[p].reversed ? shapes[p].start - at : at - shapes[p].start) / length);
  }
  for (std::size_t p = 0; p < shapes.size(); ++p) {
    const PlacedShape& placed = shapes[p];
    const Samples own = placed.shape.sample(own_s[p]);
    const double sense = placed.reversed ? -1 : 1;
    for (std::size_t k = 0; k < columns[p].size(); ++k) {
      const Eigen::Index i = columns[p][k];
      const auto from = static_cast<Eigen::Index>(k);
      samples.points.col(i) = placed.anchor + length * (placed.to_space * own.points.col(from));
      samples.tangents.col(i) = sense * (placed.to_space * own.tangents.col(from));
      samples.curvature.col(i) = placed.to_space * own.curvature.col(from) / length;
      if (!placed.ahead) continue;
      const Eigen::AngleAxisd about(placed.ahead(own_s[p][k]), own.tangents.col(from));
      samples.d1.col(i) = placed.to_space * (about * own.d1.col(from));
    }
  }
  return samples;
}

Equilibrium assemble(const Problem& problem, const std::vector<PlacedSpan>& placed,
                     const std::vector<const SpanSolution*>& solutions) {
  Assembly assembly(problem);
  for (std::size_t i = 0; i < placed.size(); ++i) assembly.add(placed[i], *solutions[i]);
  return assembly.finish(placed, solutions);
}

}  // namespace dlo::energy_model
