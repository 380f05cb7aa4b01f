#include "shooting/span_equilibrium.hpp"

#include <algorithm>
#include <cmath>

#include "shooting/between_nodes.hpp"

namespace dlo::energy_model {
namespace {

constexpr double largest_growth = 3;  // of an interval: its length times |n|^(1/2)
/// Of the integrator for the second variation, whose elements are right to 1e-8.
constexpr double variation_tolerance = 1e-10;

void add_energies(const RodSpan& span, const RodMesh& mesh, double tolerance,
                  SpanEquilibrium& equilibrium) {
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state = equilibrium.nodes[static_cast<std::size_t>(i)];
    equilibrium.energy.load -= mesh.load.col(i).dot(state.r);
    if (i == mesh.intervals()) break;
    RodIntegrals integrals;
    if (!follow_rod(mesh.section_of(i), mesh.width(i), tolerance, state, integrals)) {
      equilibrium.converged = false;
      equilibrium.message = "the integrator gave up on the energies";
      equilibrium.energy = {NAN, NAN, NAN, NAN};
      return;
    }
    equilibrium.energy.bending += integrals.bending;
    equilibrium.energy.gravity += integrals.gravity;
  }
  if (!span.twist) return;
  const double torque = equilibrium.nodes.front().torque;
  equilibrium.energy.twisting = torque * torque * span.twist->compliance / 2;
}

}  // namespace

double longest_interval(const RodSpan& span, double force) {
  return std::min(span.length / 16, 1 / std::sqrt(std::max(force, 1.0)));
}

SpanEquilibrium shoot_span(const RodSpan& span, RodMesh mesh, std::vector<RodState> start,
                           const ShootingOptions& options) {
  SpanEquilibrium equilibrium;
  for (int level = 0; level < 3; ++level) {
    ShootingResult result = shoot(span, mesh, start, options);
    equilibrium.converged = result.converged;
    equilibrium.message = result.message;
    equilibrium.residual = result.residual;
    equilibrium.shots += result.shots;
    equilibrium.s = mesh.s;
    equilibrium.nodes = std::move(result.nodes);
    const double force = largest_force(equilibrium.nodes, softest(span));
    const double longest =
        (mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())).maxCoeff();
    if (!result.converged || longest * std::sqrt(force) <= largest_growth) break;
    mesh = make_mesh(span, longest_interval(span, force));
    start.clear();
    for (const double s : mesh.s) {
      start.push_back(state_at(equilibrium, span, s, options.tolerance));
    }
    start.back().n.setZero();
  }
  if (!equilibrium.converged) return equilibrium;
  add_energies(span, mesh, options.tolerance, equilibrium);
  judge_stability(span, options.tolerance, equilibrium);
  return equilibrium;
}

void judge_stability(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium) {
  equilibrium.stability = second_variation(span, [&](const std::vector<double>& s) {
    return states_at(equilibrium, span, s, std::max(tolerance, variation_tolerance));
  });
  std::vector<double> probes;
  for (int i = 0; i <= 32; ++i) probes.push_back(span.length * i / 32);
  equilibrium.tangents = tangents_of(states_at(equilibrium, span, probes, variation_tolerance));
  if (equilibrium.stability.negative < 0 || !equilibrium.tangents.allFinite()) {
    equilibrium.converged = false;
    equilibrium.message = "the integrator gave up on the second variation";
  }
}

RodState state_at(const SpanEquilibrium& equilibrium, const RodSpan& span, double s,
                  double tolerance) {
  return states_at(equilibrium, span, {s}, tolerance).front();
}

std::vector<RodState> states_at(const SpanEquilibrium& equilibrium, const RodSpan& span,
                                const std::vector<double>& s, double tolerance) {
  const auto follow = [&](Eigen::Index i, double from, double to, RodState& state) {
    const RodSection& section = section_at(span, (equilibrium.s[i] + equilibrium.s[i + 1]) / 2);
    RodIntegrals integrals;
    if (follow_rod(section, to - from, tolerance, state, integrals)) return;
    state.r.setConstant(NAN);
    state.t.setConstant(NAN);
    state.v.setConstant(NAN);
  };
  return states_between(equilibrium.s, equilibrium.nodes, s, follow);
}

}  // namespace dlo::energy_model
