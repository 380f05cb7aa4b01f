#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/found_equilibria.hpp"
#include "base/sized_samples.hpp"
#include "dlo/energy_model/couple_zero.hpp"
#include "problem/rod_law.hpp"
#include "shooting/second_variation.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {
namespace {

/// Adds the reactions of the grips of a span, which balance the jumps of n and m.
void add_reactions(const Problem& problem, const RodSpan& span, const SpanEquilibrium& equilibrium,
                   std::vector<Reaction>& reactions) {
  const double torque_unit = bending_unit(problem) / problem.length;
  const double force_unit = torque_unit / problem.length;
  for (const RodSpan::Hold& hold : span.holds) {
    const auto i = static_cast<std::size_t>(node_at(equilibrium.s, hold.at));
    const RodState& before = equilibrium.before[i];
    Eigen::Vector3d force = before.n - equilibrium.nodes[i].n;
    for (const RodSpan::Load& load : span.loads) {
      if (load.at != hold.at) continue;
      force -= load.follows ? before.R * load.force : load.force;
    }
    Reaction& reaction = reactions[hold.grip];
    reaction.force += force_unit * force;
    if (span.clamp_at(hold.at) == nullptr) continue;
    reaction.torque += torque_unit * (before.m - equilibrium.nodes[i].m);
  }
}

/// Adds the twist between neighbouring clamps that hold frames; the first clamp counts as one.
void add_twists(const Problem& problem, const RodSpan& span, const SpanEquilibrium& equilibrium,
                std::vector<TwistedPart>& twists) {
  if (span.clamps.empty()) return;
  auto begin = static_cast<std::size_t>(node_at(equilibrium.s, span.clamps.front().at));
  for (const RodSpan::Clamp& clamp : span.clamps) {
    if (!clamp.frame) continue;
    const auto end = static_cast<std::size_t>(node_at(equilibrium.s, clamp.at));
    TwistedPart part;
    part.begin = (span.begin + equilibrium.s[static_cast<Eigen::Index>(begin)]) * problem.length;
    part.end = (span.begin + clamp.at) * problem.length;
    for (std::size_t i = begin; i < end; ++i) part.angle += equilibrium.turns[i];
    part.torque =
        equilibrium.before[end].m.dot(clamp.direction) * bending_unit(problem) / problem.length;
    twists.push_back(part);
    begin = end;
  }
}

/// Returns the potential of the couples of a span in a plane [EI/l], relative to couple_zero().
double energy_of_couples(const Problem& problem, const RodSpan& span,
                         const SpanEquilibrium& equilibrium, double tolerance) {
  if (!span.plane) return 0;
  // So many that the tangent rotates by less than pi between two points.
  constexpr Eigen::Index sample_count = 513;
  const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y);
  double energy = 0;
  for (const RodSpan::Load& load : span.loads) {
    if (load.couple.isZero(0) || load.follows) continue;
    const double at = (span.begin + load.at) * problem.length;
    const CoupleZero zero = couple_zero(problem, {.at = at, .torque = load.couple});
    const double from = std::clamp(zero.at / problem.length - span.begin, 0.0, span.length);
    const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(sample_count, from, load.at);
    std::vector<double> sorted(s.begin(), s.end());
    if (load.at < from) std::reverse(sorted.begin(), sorted.end());
    Eigen::Matrix3Xd t = tangents_of(states_at(equilibrium, span, sorted, tolerance));
    if (load.at < from) t = t.rowwise().reverse().eval();
    Eigen::Vector3d before = zero.direction;
    for (Eigen::Index i = 0; i < sample_count; ++i) {
      const Eigen::Vector3d here = t.col(i);
      energy -=
          load.couple.dot(normal) * std::atan2(normal.dot(before.cross(here)), before.dot(here));
      before = here;
    }
  }
  return energy;
}

std::string why_no_potential(const Problem& problem) {
  if (problem.drag) return "drag has no potential";
  return has_dead_loads(problem) ? "a couple in space has no potential"
                                 : "a follower load has no potential";
}

Samples sample(const Problem& problem, const SolvedRod& rod, double tolerance,
               std::span<const double> arc_lengths) {
  const double l = problem.length;
  Samples samples = sized_samples(arc_lengths, l);
  if (rod.has_directors()) samples.d1.resize(3, samples.points.cols());
  std::vector<std::size_t> order(arc_lengths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return arc_lengths[k]; });
  std::size_t first = 0;  // index of the first arc length of a span, in order
  for (std::size_t p = 0; p < rod.spans.size(); ++p) {
    const RodSpan& span = rod.spans[p];
    const double end = p + 1 < rod.spans.size() ? rod.spans[p + 1].begin : INFINITY;
    std::vector<double> s;
    for (std::size_t k = first; k < order.size() && arc_lengths[order[k]] / l <= end; ++k) {
      s.push_back(arc_lengths[order[k]] / l - span.begin);
    }
    const std::vector<RodState> states = states_at(rod.equilibria[p], span, s, tolerance);
    for (std::size_t k = 0; k < s.size(); ++k) {
      const RodSection& section = section_at(span, std::min(s[k], span.length * (1 - 1e-12)));
      const auto i = static_cast<Eigen::Index>(order[first + k]);
      samples.points.col(i) = problem.grips.front().position + l * states[k].r;
      samples.tangents.col(i) = states[k].t();
      samples.curvature.col(i) = curvature_of(section, span.natural, s[k], states[k]) / l;
      if (rod.has_directors()) samples.d1.col(i) = states[k].R.col(0);
    }
    first += s.size();
  }
  return samples;
}

}  // namespace

Equilibrium assemble(const Problem& problem, SolvedRod solved, double tolerance) {
  const auto rod = std::make_shared<const SolvedRod>(std::move(solved));
  Equilibrium result;
  result.grips.resize(problem.grips.size());
  SecondVariation stability;
  stability.negative = stability.neutral = 0;
  stability.smallest = std::numeric_limits<double>::infinity();
  Energies energy;
  bool unjudged = false;  // whether couples act on a shape that leaves its plane
  for (std::size_t i = 0; i < rod->spans.size(); ++i) {
    const RodSpan& span = rod->spans[i];
    const SpanEquilibrium& equilibrium = rod->equilibria[i];
    result.evaluations += equilibrium.integrations;
    result.residual = std::max(result.residual, equilibrium.residual);
    if (!equilibrium.converged) {
      result.status = SolveStatus::failed;
      const std::string begin = std::to_string(span.begin * problem.length);
      const std::string where =
          rod->has_directors() ? "" : "the span that begins at " + begin + " m: ";
      result.message = where + equilibrium.message;
      continue;
    }
    energy.bending += equilibrium.energy.bending;
    energy.twisting += equilibrium.energy.twisting;
    energy.gravity += equilibrium.energy.gravity;
    energy.stretch += equilibrium.energy.stretch;
    energy.load +=
        equilibrium.energy.load + energy_of_couples(problem, span, equilibrium, tolerance);
    unjudged =
        unjudged || (span.has_couples() && out_of_plane(span, equilibrium.nodes) > plane_tolerance);
    add_reactions(problem, span, equilibrium, result.grips);
    add_twists(problem, span, equilibrium, result.twists);
    stability.negative += equilibrium.stability.negative;
    stability.neutral += equilibrium.stability.neutral;
    stability.smallest = std::min(stability.smallest, equilibrium.stability.smallest);
  }
  if (result.status == SolveStatus::failed) {
    result.energy = {NAN, NAN, NAN, NAN};
    result.grips.clear();
    result.twists.clear();
    return result;
  }
  result.energy = to_joules(problem, energy);
  add_loads_on_clamps(problem, result);
  result.status = stability.stable() ? SolveStatus::converged : SolveStatus::saddle;
  result.message = to_string(result.status) + zero_modes_note(stability.neutral);
  result.smallest_eigenvalue = stability.smallest;
  if (has_couples(problem)) result.message += planar_check_note;
  if (unjudged || !has_potential(problem)) {
    result.status = SolveStatus::not_verified;
    result.message = "an equilibrium whose balance is verified; its stability is not judged: " +
                     why_no_potential(problem);
    result.smallest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  }
  result.sample = [problem, rod, tolerance](std::span<const double> arc_lengths) {
    return sample(problem, *rod, tolerance, arc_lengths);
  };
  return result;
}

}  // namespace dlo::energy_model
