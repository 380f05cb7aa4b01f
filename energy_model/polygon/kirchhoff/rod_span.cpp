#include "kirchhoff/rod_span.hpp"

#include <algorithm>
#include <cmath>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Returns an arc length in units of l; one that is nearly at an end of the rod is moved there.
double scaled_arc_length(double at, double length) {
  const double s = at / length;
  if (s < same_arc_length_share) return 0;
  return s > 1 - same_arc_length_share ? 1 : s;
}

/// Returns the directions of clamps, of chords between grips and of forces. They are unit vectors,
/// except those of forces, which are divided by the total load.
std::vector<Eigen::Vector3d> directions_of(const RodSpan& span) {
  std::vector<Eigen::Vector3d> directions;
  for (const RodSpan::Clamp& clamp : span.clamps) directions.push_back(clamp.direction);
  for (const RodSpan::Hold& hold : span.holds) {
    const Eigen::Vector3d chord = hold.position - span.holds.front().position;
    if (chord.norm() > same_arc_length_share) directions.emplace_back(chord.normalized());
  }
  for (const RodSpan::Load& load : span.loads) {
    if (load.couple.isZero(0) || load.follows) continue;
    for (const Eigen::Vector3d& direction : plane_across(load.couple))
      directions.push_back(direction);
  }
  const double largest = total_load(span);
  if (largest > 0) {
    for (const RodSpan::Part& part : span.parts) {
      for (const double s : {part.begin, part.end}) {
        directions.emplace_back((part.section.weight + s * part.section.slope) / largest);
      }
    }
    for (const RodSpan::Load& load : span.loads) {
      if (!load.follows) directions.emplace_back(load.force / largest);
    }
    const std::optional<Drag>& drag = span.parts.front().section.drag;
    if (drag && drag->largest() > 0) directions.emplace_back(drag->velocity.normalized());
  }
  return directions;
}

std::optional<Plane> plane_of(const RodSpan& span) {
  std::vector<Eigen::Vector3d> directions = directions_of(span);
  if (directions.empty()) directions.emplace_back(Eigen::Vector3d::UnitX());
  // If a pinned rod has no unit direction, its largest force is the first direction, which may be
  // zero.
  const auto first =
      std::max_element(directions.begin(), directions.end(), [](const auto& a, const auto& b) {
        return a.norm() < b.norm() * (1 - same_arc_length_share);
      });
  if (first->norm() == 0) *first = Eigen::Vector3d::UnitX();
  return find_plane(span.holds.front().position, *first, directions);
}

/// Returns the plane across the second axis of the first frame if grips, forces and natural strains
/// keep the span in it; else std::nullopt.
std::optional<Plane> plane_across_d2(const RodSpan& span) {
  const Eigen::Vector3d normal = span.first_frame.col(1);
  for (const Eigen::Vector3d& direction : directions_of(span)) {
    if (std::abs(normal.dot(direction)) > 1e-12) return std::nullopt;
  }
  // If the polynomials of the other two strains vanish at all probes, they are zero.
  for (const Eigen::Vector3d& u : sample_natural_strains(span, 24)) {
    if (u[0] != 0 || u[2] != 0) return std::nullopt;
  }
  return Plane{span.holds.front().position, span.first_frame.col(2), span.first_frame.col(0)};
}

/// Treatment of the directors of a span: arbitrary, or fixed to the material.
enum class Directors { any, material };

/// Returns the parts of the rod from `begin` to `end`, both in units of l.
std::vector<RodSpan::Part> parts_between(const Problem& problem, double begin, double end,
                                         Directors directors) {
  const double l = problem.length;
  const double unit = bending_unit(problem);
  std::vector<RodSpan::Part> parts;
  for (const RodPart& section : rod_parts(problem)) {
    const double from = std::max(scaled_arc_length(section.begin, l), begin);
    const double to = std::min(scaled_arc_length(section.end, l), end);
    // A part shorter than the smallest distance of two arc lengths is omitted.
    if (to - from < same_arc_length_share) continue;
    RodSection own{section.bending_stiffness / unit, section.torsional_stiffness / unit,
                   section.weight_per_length * l * l * l / unit};
    if (problem.axial_stiffness) own.stretch = unit / (*problem.axial_stiffness * l * l);
    own.slope = section.weight_slope * l * l * l * l / unit;
    own.weight -= (section.begin / l - begin) * own.slope;
    if (directors == Directors::material && section.bending_stiffness_2) {
      own.bending_2 = *section.bending_stiffness_2 / unit;
    }
    if (problem.drag) {
      const double force = l * l * l / unit;
      own.drag = {problem.drag->velocity, force * problem.drag->normal,
                  force * problem.drag->tangential};
    }
    if (section.natural_curvature) own.natural_bend = l * *section.natural_curvature;
    if (section.natural_twist) own.natural_twist = l * *section.natural_twist;
    parts.push_back({from - begin, to - begin, own});
  }
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) parts[i].end = parts[i + 1].begin;
  parts.front().begin = 0;
  parts.back().end = end - begin;
  return parts;
}

/// Adds grips and clamps, with the frames that the clamps hold.
void add_grips(const Problem& problem, const std::vector<OrderedGrip>& grips, Directors directors,
               RodSpan& span) {
  const double l = problem.length;
  const Eigen::Vector3d origin = problem.grips.front().position;
  std::optional<Grip> first;  // first clamp
  for (const OrderedGrip& grip : grips) {
    const double at = scaled_arc_length(grip.grip->at, l) - span.begin;
    if (at < 0 || at > span.length) continue;
    span.holds.push_back({at, (grip.grip->position - origin) / l, grip.index});
    if (!grip.grip->direction) continue;
    RodSpan::Clamp clamp{at, grip.grip->direction->normalized(), {}};
    if (!first) {
      first = *grip.grip;
      if (directors == Directors::material) {
        if (!first->frame) first->frame = FrameHold{};
        span.first_roll = first->frame->roll;
      } else {
        const Eigen::Vector3d d1 =
            first->frame ? held_d1(problem, *first) : clamp.direction.unitOrthogonal();
        span.first_frame = frame_along(clamp.direction, d1);
      }
    } else if (first->frame && grip.grip->frame) {
      clamp.frame = RodSpan::Frame{held_d1(problem, *grip.grip),
                                   prescribed_turns(problem, *first, *grip.grip)};
    }
    span.clamps.push_back(clamp);
  }
}

void add_loads(const Problem& problem, RodSpan& span) {
  const double l = problem.length;
  const double force_unit = bending_unit(problem) / (l * l);
  for (const Load& load : problem.loads) {
    double at = scaled_arc_length(load.at, l) - span.begin;
    if (at < 0 || at > span.length || clamp_at_load(problem, load)) continue;
    for (const RodSpan::Hold& hold : span.holds) {
      if (std::abs(at - hold.at) < same_arc_length_share) at = hold.at;
    }
    span.loads.push_back(
        {at, load.force / force_unit, load.torque / (force_unit * l), load.follows});
  }
  std::ranges::stable_sort(span.loads, {}, &RodSpan::Load::at);
}

RodSpan make_span(const Problem& problem, const std::vector<OrderedGrip>& grips, double begin,
                  double end, Directors directors) {
  RodSpan span;
  span.begin = begin;
  span.length = end - begin;
  span.parts = parts_between(problem, begin, end, directors);
  add_grips(problem, grips, directors, span);
  add_loads(problem, span);
  return span;
}

/// Returns the frame at the first clamp. Without a clamp, the second axis of a rod on pins is the
/// normal of its plane.
Eigen::Matrix3d material_frame(const Problem& problem) {
  if (first_clamp(problem)) return first_frame(problem);
  const Eigen::Vector3d d2 = natural_normal(problem).value_or(Eigen::Vector3d::UnitZ());
  return frame_along(d2.unitOrthogonal().cross(d2), d2.unitOrthogonal());
}

}  // namespace

const RodSpan::Clamp* RodSpan::clamp_at(double s) const {
  const auto found = std::ranges::find(clamps, s, &Clamp::at);
  return found == clamps.end() ? nullptr : &*found;
}

bool RodSpan::twisted() const {
  return std::ranges::any_of(clamps, [](const Clamp& clamp) { return clamp.frame.has_value(); });
}

bool RodSpan::round() const {
  return !natural && std::none_of(parts.begin(), parts.end(), [](const Part& part) {
    return part.section.bending_2.has_value();
  });
}

bool RodSpan::has_couples() const {
  return std::ranges::any_of(loads, [](const Load& load) { return !load.couple.isZero(0); });
}

ClampFrames released_frames(const RodSpan& span) {
  ClampFrames frames(span.clamps.size());
  if (!frames.empty()) frames.front() = span.first_frame;
  return frames;
}

ClampFrames held_frames(const RodSpan& span) {
  ClampFrames frames = released_frames(span);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const RodSpan::Clamp& clamp = span.clamps[k];
    if (!clamp.frame) continue;
    frames[k] = rolled(frame_along(clamp.direction, clamp.frame->d1),
                       clamp.frame->turns.roll + span.first_roll);
  }
  return frames;
}

RodSpan without_frames(RodSpan span) {
  for (RodSpan::Clamp& clamp : span.clamps) clamp.frame.reset();
  return span;
}

RodSpan whole_span(const Problem& problem) {
  check(problem);
  const Directors directors =
      has_material_directors(problem) ? Directors::material : Directors::any;
  RodSpan span = make_span(problem, ordered_grips(problem), 0, 1, directors);
  if (directors == Directors::material) span.first_frame = material_frame(problem);
  return span;
}

RodSpan whole_span_with_axes(const Problem& problem) {
  const bool material = has_material_directors(problem);
  RodSpan span = material ? whole_directed_span(problem) : whole_span(problem);
  span.has_potential = has_potential(problem);
  if (material) return span;
  span.plane = plane_of(span);
  const auto across = [](const RodSpan::Load& load) {
    return load.follows && !(load.force.head<2>().isZero(0) && load.couple.head<2>().isZero(0));
  };
  const bool asks_for_d1 = std::any_of(span.loads.begin(), span.loads.end(), across);
  const bool leaves_d2 = std::ranges::any_of(span.loads, [](const RodSpan::Load& load) {
    return load.follows && (load.force.y() != 0 || load.couple.x() != 0 || load.couple.z() != 0);
  });
  require(!asks_for_d1 || !span.clamps.empty(), "solve_exact",
          "number of clamps of a rod with a follower load along d1 or d2", 0, ">= 1");
  if (asks_for_d1) {
    span.has_axes = true;
    span.first_frame = first_frame(problem);
    const Grip& clamp = problem.grips[*first_clamp(problem)];
    span.first_roll = clamp.frame ? clamp.frame->roll : 0;
    const Eigen::Vector3d d2 = span.first_frame.col(1);
    const bool flat = span.plane && span.plane->x.cross(span.plane->y).cross(d2).norm() < 1e-12;
    if (!flat) span.plane = plane_across_d2(span);
  }
  if (leaves_d2) span.plane.reset();
  require(span.plane || !asks_for_d1 || problem.torsional_stiffness > 0, "solve_exact",
          "torsional_stiffness of a rod with a follower load along d1 or d2 out of a plane",
          problem.torsional_stiffness, "> 0");
  return span;
}

RodSpan scale_nonpotential_loads(RodSpan span, double factor) {
  for (RodSpan::Part& part : span.parts) {
    if (!part.section.drag) continue;
    part.section.drag->normal *= factor;
    part.section.drag->tangential *= factor;
  }
  for (RodSpan::Load& load : span.loads) {
    load.couple *= factor;
    if (load.follows) load.force *= factor;
  }
  return span;
}

std::vector<Eigen::Vector3d> sample_natural_strains(const RodSpan& span, int count) {
  std::vector<Eigen::Vector3d> strains;
  if (!span.natural) return strains;
  for (int i = 0; i <= count; ++i) strains.push_back(span.natural(span.length * i / count));
  for (const RodSpan::Part& part : span.parts) {
    strains.push_back(part.section.natural(span.natural, (part.begin + part.end) / 2));
  }
  return strains;
}

RodSpan whole_directed_span(const Problem& problem) {
  RodSpan span = whole_span(problem);
  span.natural = [problem](double s) {
    return Eigen::Vector3d(problem.length * natural_strain(problem, s * problem.length));
  };
  span.plane = plane_across_d2(span);
  return span;
}

std::vector<RodSpan> cut_at_clamps(const Problem& problem) {
  check(problem);
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  std::vector<double> cuts = {0, 1};
  for (const OrderedGrip& grip : grips) {
    if (grip.grip->direction) cuts.push_back(scaled_arc_length(grip.grip->at, problem.length));
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<RodSpan> spans;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    spans.push_back(make_span(problem, grips, cuts[i], cuts[i + 1], Directors::any));
    spans.back().plane = plane_of(spans.back());
  }
  return spans;
}

const RodSection& section_at(const RodSpan& span, double s) {
  const auto after = std::ranges::upper_bound(span.parts, s, {}, &RodSpan::Part::begin);
  return (after == span.parts.begin() ? after : after - 1)->section;
}

double longest_interval(const RodSpan& span, double force) {
  return std::min(span.length / 16, 1 / std::sqrt(std::max(force, 1.0)));
}

double least_bending_stiffness(const RodSpan& span) {
  double least = INFINITY;
  for (const RodSpan::Part& part : span.parts) {
    least = std::min(least, part.section.stiffness().head<2>().minCoeff());
  }
  return least;
}

double total_load(const RodSpan& span) {
  double load = 0;
  for (const RodSpan::Part& part : span.parts) {
    const RodSection& own = part.section;
    load +=
        (part.end - part.begin) / 2 *
        ((own.weight + part.begin * own.slope).norm() + (own.weight + part.end * own.slope).norm());
    if (own.drag) load += (part.end - part.begin) * own.drag->largest();
  }
  for (const RodSpan::Load& l : span.loads) load += l.force.norm() + l.couple.norm() / span.length;
  return load;
}

}  // namespace dlo::energy_model
