#include "problem/reduction.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "base/legendre.hpp"
#include "base/require.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {

std::optional<ReducedCantilever> reduce_cantilever(const Problem& problem) {
  check(problem);
  const Grip& grip = problem.grips.front();
  const bool at_end = grip.at == 0 || grip.at == problem.length;
  if (problem.grips.size() != 1 || !grip.direction || !at_end) return std::nullopt;
  ReducedCantilever reduced;
  reduced.reversed = grip.at != 0;
  std::vector<Eigen::Vector3d> forces = {weight_everywhere(problem) * problem.length};
  for (const Load& load : problem.loads) {
    forces.push_back(load.force);
    if (load.torque.isZero(0)) continue;
    for (const Eigen::Vector3d& direction : plane_across(load.torque)) forces.push_back(direction);
  }
  const std::optional<Plane> plane =
      find_plane(grip.position,
                 reduced.reversed ? Eigen::Vector3d(-*grip.direction) : *grip.direction, forces);
  if (!plane) return std::nullopt;
  reduced.plane = *plane;
  const double unit = problem.bending_stiffness / (problem.length * problem.length);
  reduced.rod.weight = plane->coordinates(forces.front()) / unit;
  for (const Load& load : problem.loads) {
    const double s = reduced.reversed ? 1 - load.at / problem.length : load.at / problem.length;
    if (!(s > 0)) continue;
    const double couple = plane->x.cross(plane->y).dot(load.torque) / (unit * problem.length);
    reduced.rod.loads.push_back({s, plane->coordinates(load.force) / unit, couple});
  }
  std::sort(reduced.rod.loads.begin(), reduced.rod.loads.end(),
            [](const auto& a, const auto& b) { return a.at < b.at; });
  return reduced;
}

std::vector<double> distances_from_clamp(const Problem& problem, bool reversed,
                                         std::span<const double> arc_lengths) {
  std::vector<double> distances(arc_lengths.begin(), arc_lengths.end());
  for (double& s : distances) {
    require(s >= 0 && s <= problem.length, "sample", "arc length", s,
            "in [0, " + std::to_string(problem.length) + "]");
    s = reversed ? 1 - s / problem.length : s / problem.length;
  }
  return distances;
}

Samples restore(const Problem& problem, const ReducedCantilever& reduced,
                std::span<const double> arc_lengths, const PlanarSamples& planar) {
  const Eigen::Index count = planar.angle.size();
  Samples samples;
  samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
  samples.points.resize(3, count);
  samples.tangents.resize(3, count);
  samples.curvature.resize(3, count);
  const double direction = reduced.reversed ? -1 : 1;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double angle = planar.angle[i];
    samples.points.col(i) =
        reduced.plane.origin + problem.length * reduced.plane.vector(planar.points.col(i));
    samples.tangents.col(i) = direction * reduced.plane.vector({std::cos(angle), std::sin(angle)});
    samples.curvature.col(i) = planar.curvature[i] / problem.length *
                               reduced.plane.vector({-std::sin(angle), std::cos(angle)});
  }
  return samples;
}

Reaction clamp_reaction(const Problem& problem, const ReducedCantilever& reduced,
                        double clamp_curvature) {
  Reaction reaction;
  reaction.force = -weight_everywhere(problem) * problem.length;
  for (const Load& load : problem.loads) reaction.force -= load.force;
  reaction.torque = -problem.bending_stiffness * clamp_curvature / problem.length *
                    reduced.plane.x.cross(reduced.plane.y);
  for (const Load& load : problem.loads) {
    if (load.at == problem.grips.front().at) reaction.torque -= load.torque;
  }
  return reaction;
}

Energies restore(const Problem& problem, const Energies& own_units) {
  const double unit = bending_unit(problem) / problem.length;
  return {.bending = own_units.bending * unit,
          .twisting = own_units.twisting * unit,
          .gravity = own_units.gravity * unit,
          .load = own_units.load * unit,
          .stretch = own_units.stretch * unit};
}

void separate_line_loads(const Problem& problem, Equilibrium& result) {
  if (problem.line_loads.empty() || !result.sample) return;
  constexpr int panels = 16;  // per interval between two kinks
  const LegendreTable& rule = legendre_table(6);
  std::vector<double> kinks = {0, problem.length};
  for (const Grip& grip : problem.grips) kinks.push_back(grip.at);
  for (const Load& load : problem.loads) kinks.push_back(load.at);
  for (const Section& part : problem.sections) kinks.insert(kinks.end(), {part.begin, part.end});
  for (const LineLoad& load : problem.line_loads) {
    kinks.insert(kinks.end(), {load.begin, load.end});
  }
  for (const ContactPart& part : result.contacts) kinks.insert(kinks.end(), {part.begin, part.end});
  std::sort(kinks.begin(), kinks.end());
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
