#include "curved/curved_solution.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "base/sized_samples.hpp"
#include "curved/curved_search.hpp"
#include "problem/reduction.hpp"
#include "problem/rod_law.hpp"
#include "shooting/second_variation.hpp"

namespace dlo::energy_model {
namespace {

/// What lies before the nodes: forces and moments just before what the nodes add.
std::vector<CurvedState> before_nodes(const CurvedRod& rod, const CurvedEquilibrium& shape,
                                      double tolerance) {
  const RodMesh mesh = mesh_at(rod.span, shape.s);
  std::vector<CurvedState> before(1);
  for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
    CurvedState end = shape.nodes[static_cast<std::size_t>(i)];
    CurvedVariation none;
    CurvedIntegrals integrals;
    if (!follow_curved(mesh.section_of(i), rod.natural, mesh.s[i], mesh.width(i), tolerance, end,
                       none, integrals)) {
      end.m.setConstant(NAN);
    }
    before.push_back(end);
  }
  return before;
}

std::size_t node_at(const CurvedEquilibrium& shape, double s) {
  return static_cast<std::size_t>(std::lower_bound(shape.s.begin(), shape.s.end(), s) -
                                  shape.s.begin());
}

std::vector<Reaction> reactions_of(const Problem& problem, const CurvedRod& rod,
                                   const CurvedEquilibrium& shape,
                                   const std::vector<CurvedState>& before) {
  const double torque_unit = bending_unit(problem) / problem.length;
  const double force_unit = torque_unit / problem.length;
  std::vector<Reaction> reactions(problem.grips.size());
  for (const RodSpan::Hold& hold : rod.span.holds) {
    const std::size_t i = node_at(shape, hold.at);
    Eigen::Vector3d force = before[i].n - shape.nodes[i].n;
    for (const RodSpan::Load& load : rod.span.loads) {
      if (load.at == hold.at) force -= load.force;
    }
    Reaction& reaction = reactions[hold.grip];
    reaction.force = force_unit * (rod.axes * force);
    if (rod.clamp_at(hold.at) == nullptr) continue;
    reaction.torque = torque_unit * (rod.axes * (before[i].m - shape.nodes[i].m));
  }
  return reactions;
}

/// Between neighbouring clamps that hold frames, of which the first one is one.
std::vector<TwistedPart> twists_of(const Problem& problem, const CurvedRod& rod,
                                   const CurvedEquilibrium& shape,
                                   const std::vector<CurvedState>& before) {
  std::vector<TwistedPart> parts;
  if (rod.clamps.empty()) return parts;
  std::size_t begin = node_at(shape, rod.clamps.front().at);
  for (const CurvedRod::Clamp& clamp : rod.clamps) {
    if (!clamp.frame) continue;
    const std::size_t end = node_at(shape, clamp.at);
    TwistedPart part;
    part.begin = shape.s[static_cast<Eigen::Index>(begin)] * problem.length;
    part.end = clamp.at * problem.length;
    for (std::size_t i = begin; i < end; ++i) part.angle += shape.turns[i];
    part.torque = before[end].m.dot(clamp.direction) * bending_unit(problem) / problem.length;
    parts.push_back(part);
    begin = end;
  }
  return parts;
}

Samples sample_curved(const CurvedRod& rod, const CurvedEquilibrium& shape, double tolerance,
                      std::span<const double> arc_lengths) {
  const auto count = static_cast<Eigen::Index>(arc_lengths.size());
  Samples samples = sized_samples(arc_lengths, rod.length);
  samples.d1.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = arc_lengths[static_cast<std::size_t>(i)];
    const double s = at / rod.length;
    const CurvedState state = curved_states_at(shape, rod, {s}, tolerance).front();
    const RodSection& section = section_at(rod.span, std::min(s, 1 - 1e-12));
    const Eigen::Vector3d u = strain_of(section, rod.natural, s, state);
    samples.points.col(i) = rod.origin + rod.length * (rod.axes * state.r);
    samples.tangents.col(i) = rod.axes * state.t();
    samples.d1.col(i) = rod.axes * state.R.col(0);
    samples.curvature.col(i) =
        rod.axes * (u[1] * state.R.col(0) - u[0] * state.R.col(1)) / rod.length;
  }
  return samples;
}

Equilibrium assemble_curved(const Problem& problem, const std::shared_ptr<const CurvedRod>& rod,
                            const CurvedEquilibrium& shape, double tolerance) {
  Equilibrium result;
  result.evaluations = shape.shots;
  result.residual = shape.residual;
  if (!shape.converged) {
    result.status = SolveStatus::failed;
    result.message = shape.message;
    result.energy = {NAN, NAN, NAN, NAN};
    return result;
  }
  result.energy = restore(problem, shape.energy);
  const std::vector<CurvedState> before = before_nodes(*rod, shape, tolerance);
  result.grips = reactions_of(problem, *rod, shape, before);
  result.twists = twists_of(problem, *rod, shape, before);
  judge({.negative = shape.stability.negative,
         .neutral = shape.stability.neutral,
         .smallest = shape.stability.smallest,
         .s = {},
         .direction = {}},
        result);
  result.sample = [rod, shape, tolerance](std::span<const double> arc_lengths) {
    return sample_curved(*rod, shape, tolerance, arc_lengths);
  };
  return result;
}

}  // namespace

CurvedSolutions solve_curved(const Problem& problem, const ExactOptions& options,
                             const Deadline& deadline) {
  const auto rod = std::make_shared<const CurvedRod>(make_curved_rod(problem));
  CurvedSolutions result;
  std::vector<CurvedEquilibrium> found;
  if (options.start == nullptr) {
    CurvedSearchResult search = search_curved(*rod, options.tolerance, deadline);
    found = std::move(search.found);
    result.out_of_time = !search.complete;
  } else {
    found = {refine_curved(*rod, problem, *options.start, options.tolerance, deadline)};
    result.out_of_time = deadline.passed();
  }
  for (const CurvedEquilibrium& shape : found) {
    result.equilibria.push_back(assemble_curved(problem, rod, shape, options.tolerance));
  }
  return result;
}

}  // namespace dlo::energy_model
