#include "problem/reduction.hpp"

#include <Eigen/Geometry>
#include <algorithm>

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
  std::vector<Eigen::Vector3d> forces = {problem.weight_per_length * problem.length};
  for (const Load& load : problem.loads) forces.push_back(load.force);
  const std::optional<Plane> plane =
      find_plane(grip.position,
                 reduced.reversed ? Eigen::Vector3d(-*grip.direction) : *grip.direction, forces);
  if (!plane) return std::nullopt;
  reduced.plane = *plane;
  const double unit = problem.bending_stiffness / (problem.length * problem.length);
  reduced.rod.weight = plane->coordinates(forces.front()) / unit;
  for (const Load& load : problem.loads) {
    const double s = reduced.reversed ? 1 - load.at / problem.length : load.at / problem.length;
    if (s > 0) reduced.rod.loads.push_back({s, plane->coordinates(load.force) / unit});
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
  reaction.force = -problem.weight_per_length * problem.length;
  for (const Load& load : problem.loads) reaction.force -= load.force;
  reaction.torque = -problem.bending_stiffness * clamp_curvature / problem.length *
                    reduced.plane.x.cross(reduced.plane.y);
  return reaction;
}

Energies restore(const Problem& problem, const Energies& own_units) {
  const double unit = bending_unit(problem) / problem.length;
  return {.bending = own_units.bending * unit,
          .twisting = own_units.twisting * unit,
          .gravity = own_units.gravity * unit,
          .load = own_units.load * unit};
}

}  // namespace dlo::energy_model
