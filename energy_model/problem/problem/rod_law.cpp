#include "problem/rod_law.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/legendre.hpp"
#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/plane.hpp"
#include "problem/natural_strains.hpp"

namespace dlo::energy_model {

namespace {

/// Cuts parts where a line load begins or ends, and adds the load to the parts within it.
void add_line_load(const LineLoad& load, std::vector<RodPart>& parts) {
  std::vector<RodPart> cut;
  for (RodPart& part : parts) {
    for (const double at : {load.begin, load.end}) {
      if (!(at > part.begin && at < part.end)) continue;
      cut.push_back(part);
      cut.back().end = at;
      part.weight_per_length += (at - part.begin) * part.weight_slope;
      part.begin = at;
    }
    cut.push_back(part);
  }
  for (RodPart& part : cut) {
    if (part.begin < load.begin || part.end > load.end) continue;
    part.weight_per_length += load.at_begin + (part.begin - load.begin) * load.slope();
    part.weight_slope += load.slope();
  }
  parts = std::move(cut);
}

/// Calls `add` with the directions in which loads act, and with two directions across each couple.
void add_loads(const Problem& problem, const std::function<void(const Eigen::Vector3d&)>& add) {
  for (const LineLoad& load : problem.line_loads) {
    add(load.at_begin);
    add(load.at_end);
  }
  if (problem.drag) add(problem.drag->velocity);
  for (const Load& load : problem.loads) {
    if (load.follows) continue;  // the direction is given in the axes of the section
    add(load.force);
    if (load.torque.isZero(0)) continue;
    for (const Eigen::Vector3d& direction : plane_across(load.torque)) add(direction);
  }
}

/// Whether a load moves the rod out of a plane by more than about 1e-6 of its length.
bool loads_leave_plane(const Problem& problem, const Eigen::Vector3d& normal) {
  constexpr double negligible_load_share = 1e-6;
  const double most =
      negligible_load_share * bending_unit(problem) / (problem.length * problem.length);
  const auto leaves = [&](const Eigen::Vector3d& force) {
    return std::abs(force.dot(normal)) > most;
  };
  const bool line_leaves = std::ranges::any_of(problem.line_loads, [&](const LineLoad& load) {
    return leaves(load.at_begin * problem.length) || leaves(load.at_end * problem.length);
  });
  const bool drag_leaves = problem.drag && std::abs(problem.drag->velocity.dot(normal)) >
                                               direction_rounding * problem.drag->velocity.norm();
  return line_leaves || drag_leaves || std::ranges::any_of(problem.loads, [&](const Load& load) {
           if (load.follows) return false;  // the direction is given in the axes of the section
           const Eigen::Vector3d couple = load.torque / problem.length;
           return leaves(load.force) || (couple - couple.dot(normal) * normal).norm() > most;
         });
}

}  // namespace

std::vector<RodPart> rod_parts(const Problem& problem) {
  std::vector<RodPart> parts;
  double at = 0;
  const auto add_section_until = [&](double end) {
    if (end > at) {
      parts.push_back({{at, end, problem.bending_stiffness, problem.torsional_stiffness,
                        problem.weight_per_length, problem.bending_stiffness_2}});
    }
  };
  for (const Section& section : problem.sections) {
    add_section_until(section.begin);
    parts.push_back({section});
    at = section.end;
  }
  add_section_until(problem.length);
  for (const LineLoad& load : problem.line_loads) add_line_load(load, parts);
  return parts;
}

double torsional_compliance(const std::vector<RodPart>& parts, double begin, double end) {
  double compliance = 0;
  for (const RodPart& part : parts) {
    const double length = std::min(end, part.end) - std::max(begin, part.begin);
    if (length > 0) compliance += length / part.torsional_stiffness;
  }
  return compliance;
}

bool is_uniform_over_rod(const LineLoad& load, const Problem& problem) {
  return load.begin == 0 && load.end == problem.length && load.at_begin == load.at_end;
}

Eigen::Vector3d total_uniform_weight(const Problem& problem) {
  Eigen::Vector3d weight = problem.weight_per_length;
  for (const LineLoad& load : problem.line_loads) {
    if (is_uniform_over_rod(load, problem)) weight += load.at_begin;
  }
  return weight;
}

bool has_two_stiffnesses(const Problem& problem) {
  return problem.bending_stiffness_2 ||
         std::ranges::any_of(problem.sections, [](const Section& section) {
           return section.bending_stiffness_2.has_value();
         });
}

bool has_dead_loads(const Problem& problem) {
  return !problem.drag && std::ranges::none_of(problem.loads, &Load::follows);
}

int clamps_with_frames(const Problem& problem) {
  return static_cast<int>(std::ranges::count_if(
      problem.grips, [](const Grip& grip) { return grip.frame.has_value(); }));
}

void require_inextensible(const Problem& problem, std::string_view function) {
  require(!problem.axial_stiffness, function, "axial_stiffness",
          problem.axial_stiffness.value_or(0),
          "omitted: only solve_exact() supports an extensible rod");
}

double bending_unit(const Problem& problem) {
  return std::min(problem.bending_stiffness,
                  problem.bending_stiffness_2.value_or(problem.bending_stiffness));
}

Eigen::Vector3d principal_stiffness(const Section& section, double unit) {
  return Eigen::Vector3d(section.bending_stiffness,
                         section.bending_stiffness_2.value_or(section.bending_stiffness),
                         section.torsional_stiffness) /
         unit;
}

Eigen::Vector3d natural_strain(const Problem& problem, double arc_length) {
  NaturalStrains strains{problem.natural_strains, -1, 2 / problem.length, {}};
  for (const Section& section : problem.sections) {
    if (!section.natural_curvature && !section.natural_twist) continue;
    strains.parts.push_back(
        {section.begin, section.end, section.natural_curvature, section.natural_twist});
  }
  return strains.at(arc_length);
}

std::optional<Eigen::Vector3d> natural_normal(const Problem& problem) {
  // find_plane() takes one vector as the direction of the rod and compares the others with the
  // largest of them, so all are scaled to unit length.
  std::vector<Eigen::Vector3d> directions;
  const auto add = [&](const Eigen::Vector3d& v) {
    if (v.norm() > 0) directions.push_back(v.normalized());
  };
  for (const Grip& grip : problem.grips) {
    if (grip.direction) add(*grip.direction);
    const Eigen::Vector3d offset = grip.position - problem.grips.front().position;
    if (offset.norm() > same_arc_length_share * problem.length) add(offset);
  }
  add(problem.weight_per_length);
  for (const Section& section : problem.sections) add(section.weight_per_length);
  // Loads do not determine the plane of a curved stress-free shape.
  const bool is_straight = problem.natural_strains.empty();
  if (is_straight) add_loads(problem, add);
  for (const Obstacle& obstacle : problem.obstacles) {
    if (obstacle.body.is_half_space()) add(obstacle.body.normal());
  }
  // Without another direction, a line in x-y determines the plane x-y.
  const Eigen::Vector3d first = directions.empty() ? Eigen::Vector3d::UnitX() : directions.front();
  const auto is_along_first = [&](const Eigen::Vector3d& v) {
    return v.cross(first).norm() <= direction_rounding;
  };
  const std::optional<Plane> plane = find_plane(Eigen::Vector3d::Zero(), first, directions);
  if (!plane) return std::nullopt;
  Eigen::Vector3d normal = plane->normal();
  for (const Eigen::Index axis : {2, 1, 0}) {
    if (std::abs(normal[axis]) <= direction_rounding) continue;
    if (normal[axis] < 0) normal = -normal;
    const bool is_line = std::ranges::all_of(directions, is_along_first);
    if (!is_straight && is_line && axis != 2) return std::nullopt;
    break;
  }
  const Eigen::Vector3d& within = problem.grips.front().position;
  const bool symmetric = std::ranges::all_of(problem.obstacles, [&](const Obstacle& obstacle) {
    return obstacle.body.is_symmetric(within, normal, problem.length);
  });
  if (!symmetric || (!is_straight && loads_leave_plane(problem, normal))) return std::nullopt;
  return normal;
}

std::optional<std::size_t> first_clamp(const Problem& problem) {
  std::optional<std::size_t> first;
  for (std::size_t g = 0; g < problem.grips.size(); ++g) {
    const Grip& grip = problem.grips[g];
    if (grip.direction && (!first || grip.at < problem.grips[*first].at)) first = g;
  }
  return first;
}

Eigen::Matrix3d held_frame(const Grip& clamp, const Eigen::Vector3d& d1) {
  const Eigen::Vector3d t = clamp.direction->normalized();
  const double roll = clamp.frame ? clamp.frame->roll : 0;
  return frame_along(t, d1) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
}

Eigen::Matrix3d first_frame(const Problem& problem) {
  const Grip& clamp = problem.grips.at(first_clamp(problem).value());
  if (clamp.frame && clamp.frame->d1) return held_frame(clamp, *clamp.frame->d1);
  const std::optional<Eigen::Vector3d> normal = natural_normal(problem);
  require(
      normal.has_value(), "Problem", "arc length of the first clamp, whose frame lacks d1",
      clamp.at,
      "the arc length of a clamp with d1: the rod is not both round and straight, and lies in no "
      "plane");
  return held_frame(clamp, normal->cross(*clamp.direction));
}

std::vector<OrderedGrip> grips_by_arc_length(const Problem& problem) {
  std::vector<OrderedGrip> grips;
  grips.reserve(problem.grips.size());
  for (std::size_t i = 0; i < problem.grips.size(); ++i) grips.push_back({i, &problem.grips[i]});
  std::ranges::stable_sort(grips, {}, [](const OrderedGrip& each) { return each.grip->at; });
  return grips;
}

std::vector<OrderedGrip> ordered_grips(const Problem& problem) {
  const std::vector<OrderedGrip> grips = grips_by_arc_length(problem);
  for (std::size_t i = 0; i + 1 < grips.size(); ++i) {
    const double rod = grips[i + 1].grip->at - grips[i].grip->at;
    const double distance = (grips[i + 1].grip->position - grips[i].grip->position).norm();
    const bool reaches = distance < rod || problem.axial_stiffness;
    if (rod > same_arc_length_share * problem.length && reaches) continue;
    std::ostringstream message;
    message << "Problem: grips at arc lengths " << grips[i].grip->at << " m and "
            << grips[i + 1].grip->at << " m are " << distance << " m apart, must be less than the "
            << rod << " m of rod between them";
    throw std::invalid_argument(message.str());
  }
  return grips;
}

std::optional<std::size_t> clamp_at_load(const Problem& problem, const Load& load) {
  std::optional<std::size_t> nearest;
  double least = same_arc_length_share * problem.length;
  for (std::size_t g = 0; g < problem.grips.size(); ++g) {
    const double distance = std::abs(problem.grips[g].at - load.at);
    if (!problem.grips[g].direction || distance > least) continue;
    least = distance;
    nearest = g;
  }
  return nearest;
}

void add_loads_on_clamps(const Problem& problem, Equilibrium& result) {
  for (const Load& load : problem.loads) {
    const std::optional<std::size_t> clamp = clamp_at_load(problem, load);
    if (!clamp) continue;
    const Eigen::Vector3d& position = problem.grips[*clamp].position;
    result.grips[*clamp].force -= load.force;
    result.grips[*clamp].torque -= load.torque;
    result.energy.load -= load.force.dot(position - problem.grips.front().position);
  }
}

Energies to_joules(const Problem& problem, const Energies& own_units) {
  const double unit = bending_unit(problem) / problem.length;
  return {.bending = own_units.bending * unit,
          .twisting = own_units.twisting * unit,
          .gravity = own_units.gravity * unit,
          .load = own_units.load * unit,
          .stretch = own_units.stretch * unit};
}

std::vector<double> kink_positions(const Problem& problem,
                                   const std::vector<ContactPart>& contacts) {
  std::vector<double> at = {0, problem.length};
  for (const Grip& grip : problem.grips) at.push_back(grip.at);
  for (const Load& load : problem.loads) at.push_back(load.at);
  for (const Section& part : problem.sections) at.insert(at.end(), {part.begin, part.end});
  for (const LineLoad& load : problem.line_loads) at.insert(at.end(), {load.begin, load.end});
  for (const ContactPart& part : contacts) at.insert(at.end(), {part.begin, part.end});
  // Rounding may have moved them off the rod.
  for (double& s : at) s = std::clamp(s, 0.0, problem.length);
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  return at;
}

void separate_line_loads(const Problem& problem, Equilibrium& result) {
  if (problem.line_loads.empty() || !result.sample) return;
  constexpr int panels = 16;  // per interval between two kinks
  const LegendreTable& rule = legendre_table(6);
  const std::vector<double> kinks = kink_positions(problem, result.contacts);
  std::vector<double> s;
  std::vector<double> weights;
  for (std::size_t i = 0; i + 1 < kinks.size(); ++i) {
    const double width = (kinks[i + 1] - kinks[i]) / panels;
    for (int k = 0; k < panels && width > 0; ++k) {
      for (Eigen::Index q = 0; q < rule.nodes.size(); ++q) {
        s.push_back(std::min(kinks[i] + (k + rule.nodes[q]) * width, problem.length));
        weights.push_back(width * rule.weights[q]);
      }
    }
  }
  const Samples shape = result.sample(s);
  double energy = 0;
  for (const LineLoad& load : problem.line_loads) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (s[i] < load.begin || s[i] > load.end) continue;
      const Eigen::Vector3d force = load.at_begin + (s[i] - load.begin) * load.slope();
      energy -= weights[i] * force.dot(shape.points.col(static_cast<Eigen::Index>(i)) -
                                       problem.grips.front().position);
    }
  }
  result.energy.load += energy;
  result.energy.gravity -= energy;
}

}  // namespace dlo::energy_model
