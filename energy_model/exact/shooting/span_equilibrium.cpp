#include "shooting/span_equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/spin.hpp"

namespace dlo::energy_model {
namespace {

void add_energies(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium) {
  const RodMesh mesh = closed_mesh(span, equilibrium);
  equilibrium.before.resize(1);
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state = equilibrium.nodes[static_cast<std::size_t>(i)];
    equilibrium.energy.load -= mesh.load.col(i).dot(state.r);
    if (i == mesh.intervals()) break;
    const auto integrals = integrate_rod(rod_element(span, mesh, i), tolerance, state);
    if (!integrals) {
      equilibrium.converged = false;
      equilibrium.message = "the integrator failed while computing the energies";
      equilibrium.energy = {NAN, NAN, NAN, NAN};
      return;
    }
    equilibrium.energy.bending += integrals->bending;
    equilibrium.energy.twisting += integrals->twisting;
    equilibrium.energy.gravity += integrals->gravity;
    equilibrium.energy.stretch += integrals->stretch;
    equilibrium.turns.push_back(integrals->turn);
    equilibrium.before.push_back(state);
  }
}

}  // namespace

double longest_of(const RodMesh& mesh) {
  return (mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())).maxCoeff();
}

double out_of_plane(const RodSpan& span, const std::vector<RodState>& states) {
  if (!span.plane) return INFINITY;
  const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y);
  return (normal.transpose() * tangents_of(states)).cwiseAbs().maxCoeff();
}

double bending_force(const RodSpan& span, const std::vector<RodState>& states) {
  const double b = least_bending_stiffness(span);
  double force = 1;
  for (const RodState& state : states) {
    force = std::max({force, state.n.norm() / b, state.m.squaredNorm() / (b * b)});
  }
  for (const Eigen::Vector3d& bend : sample_natural_strains(span, 16)) {
    force = std::max(force, bend.squaredNorm());
  }
  return force;
}

SpanEquilibrium close_span(const RodSpan& span, const RodMesh& mesh,
                           const std::vector<RodState>& start, const ClampFrames& frames,
                           const ShootingOptions& options) {
  const ShootingSystem system(span, mesh, frames, options, start);
  SpanEquilibrium equilibrium;
  equilibrium.frames = frames;
  equilibrium.contacts = mesh.contacts;
  ShootingPoint point = system.start();
  const Modes modes = span.round() && span.twisted() ? Modes::nearly_zero : Modes::stiff;
  ShootingResult closed = solve_shooting(system, point, options.max_iterations, modes);
  equilibrium.converged = closed.converged;
  equilibrium.message = std::move(closed.message);
  equilibrium.integrations = closed.integrations;
  equilibrium.residual = system.gap(point);
  equilibrium.s = std::move(point.s);
  equilibrium.nodes = std::move(point.nodes);
  for (std::size_t k = 0; k < point.forces.size(); ++k) {
    equilibrium.contacts.nodes[k].force = point.forces[k];
  }
  if (!equilibrium.converged) return equilibrium;
  equilibrium.converged = equilibrium.residual <= system.closed_gap_tolerance();
  equilibrium.message = equilibrium.converged ? "converged" : "the rod has a gap at a node";
  return equilibrium;
}

SpanEquilibrium shoot_span(const RodSpan& span, RodMesh mesh, std::vector<RodState> start,
                           const ClampFrames& frames, const ShootingOptions& options) {
  SpanEquilibrium equilibrium;
  for (int level = 0; level < 3; ++level) {
    const int integrations = equilibrium.integrations;
    equilibrium = close_span(span, mesh, start, frames, options);
    equilibrium.integrations += integrations;
    if (!equilibrium.converged) return equilibrium;
    const double force = bending_force(span, equilibrium.nodes);
    if (longest_of(mesh) * std::sqrt(force) <= largest_growth) break;
    mesh = make_mesh(span, longest_interval(span, force));
    start = states_at(equilibrium, span, {mesh.s.begin(), mesh.s.end()}, options.tolerance);
    start.back().n.setZero();
    start.back().m.setZero();
  }
  complete(span, options.tolerance, equilibrium);
  return equilibrium;
}

RodMesh closed_mesh(const RodSpan& span, const SpanEquilibrium& equilibrium) {
  RodMesh mesh = mesh_at(span, equilibrium.s);
  mesh.contacts = equilibrium.contacts;
  return mesh;
}

void complete(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium) {
  add_energies(span, tolerance, equilibrium);
  if (!span.has_potential) {
    equilibrium.stability.negative = 0;  // without a potential no eigenvalue is counted
    equilibrium.stability.neutral = 0;
  } else if (equilibrium.converged) {
    judge_stability(span, tolerance, equilibrium);
  }
}

void judge_stability(const RodSpan& span, double tolerance, SpanEquilibrium& equilibrium) {
  equilibrium.stability = second_variation(
      span, closed_mesh(span, equilibrium), equilibrium.frames,
      bending_force(span, equilibrium.nodes), [&](const std::vector<double>& s) {
        return states_at(equilibrium, span, s, std::max(tolerance, coarse_tolerance));
      });
  if (equilibrium.stability.negative < 0) {
    equilibrium.converged = false;
    equilibrium.message = "the integrator failed while computing the second variation";
  }
}

std::vector<RodState> states_at(const SpanEquilibrium& equilibrium, const RodSpan& span,
                                const std::vector<double>& s, double tolerance) {
  const Eigen::VectorXd& nodes = equilibrium.s;
  std::vector<RodState> result;
  result.reserve(s.size());
  RodState state;
  Eigen::Index interval = -1;
  double reached = 0;
  for (const double at : s) {
    // The state at the end is integrated too, because the last node may be the state after the
    // action of a grip there.
    const Eigen::Index after = std::upper_bound(nodes.begin(), nodes.end(), at) - nodes.begin();
    const Eigen::Index i = std::clamp<Eigen::Index>(after - 1, 0, nodes.size() - 2);
    if (i != interval) {
      state = equilibrium.nodes[static_cast<std::size_t>(i)];
      interval = i;
      reached = nodes[i];
    }
    if (at > reached) {
      const RodElement piece{section_at(span, (nodes[i] + nodes[i + 1]) / 2), span.natural, reached,
                             at - reached, equilibrium.contacts.surface_of(i)};
      if (!integrate_rod(piece, tolerance, state)) {
        state.r.setConstant(std::numeric_limits<double>::quiet_NaN());
        state.R.setConstant(std::numeric_limits<double>::quiet_NaN());
      }
    }
    reached = at;
    result.push_back(state);
  }
  return result;
}

void carry_frames(const RodSpan& span, const RodMesh& mesh, double tolerance,
                  std::vector<RodState>& states) {
  const auto first =
      static_cast<std::size_t>(span.clamps.empty() ? 0 : node_at(mesh.s, span.clamps.front().at));
  RodState& first_state = states[first];
  first_state.R = span.clamps.empty()
                      ? frame_along(first_state.t(), first_state.t().unitOrthogonal())
                      : transported(span.first_frame, first_state.t());
  // Returns the frame at the end of an interval that results from the frame at its begin.
  const auto carried = [&](std::size_t i) {
    RodState state = states[i];
    const RodElement piece = rod_element(span, mesh, static_cast<Eigen::Index>(i));
    const bool followed = integrate_rod(piece, tolerance, state).has_value();
    return transported(followed ? state.R : states[i].R, states[i + 1].t());
  };
  for (std::size_t i = first; i + 1 < states.size(); ++i) states[i + 1].R = carried(i);
  for (std::size_t i = first; i > 0; --i) {
    states[i - 1].R = transported(states[i].R, states[i - 1].t());
    const Eigen::Matrix3d reached = carried(i - 1);
    const Eigen::Vector3d d1 = states[i].R.col(0);
    const double missing = std::atan2(reached.col(1).dot(d1), reached.col(0).dot(d1));
    states[i - 1].R = rolled(states[i - 1].R, missing);
  }
}

}  // namespace dlo::energy_model
