#include <algorithm>
#include <cmath>
#include <utility>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "problem/rod_law.hpp"
#include "shooting/continuation.hpp"
#include "shooting/span_search.hpp"

namespace dlo::energy_model {
namespace {

constexpr double largest_force = 1e6;  // largest force over b that the first mesh resolves

/// Returns the twist that a shape has for a span whose clamps hold frames; null if it has none.
const TwistedPart* twist_of(const RodSpan& span, const Problem& problem, const Equilibrium& shape) {
  if (!span.twisted()) return nullptr;
  const double middle = (span.begin + span.length / 2) * problem.length;
  const auto found = std::find_if(shape.twists.begin(), shape.twists.end(), [&](const auto& part) {
    return part.begin < middle && middle < part.end;
  });
  return found == shape.twists.end() ? nullptr : &*found;
}

Samples sample_at(const RodSpan& span, const Problem& problem, const Equilibrium& shape,
                  const Eigen::VectorXd& s) {
  std::vector<double> arc_lengths;
  for (const double at : s) {
    arc_lengths.push_back(std::min((span.begin + at) * problem.length, problem.length));
  }
  // At a clamp the curvature jumps; the value on this side is required.
  if (span.begin > 0) arc_lengths.front() += 1e-12 * problem.length;
  return shape.sample(arc_lengths);
}

/// Returns states of a round rod: the moment is computed from the curvature and a torque.
std::vector<RodState> states_by_curvature(const RodSpan& span, const Problem& problem,
                                          const Equilibrium& shape, const RodMesh& mesh,
                                          double torque) {
  const Samples samples = sample_at(span, problem, shape, mesh.s);
  std::vector<RodState> states;
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state;
    const Eigen::Vector3d t = samples.tangents.col(i);
    state.r = (samples.points.col(i) - problem.grips.front().position) / problem.length;
    state.R = frame_along(t, t.unitOrthogonal());
    if (i < mesh.intervals()) {
      const Eigen::Vector3d curvature = samples.curvature.col(i) * problem.length;
      state.m = mesh.section_of(i).bending * t.cross(curvature) + torque * t;
      state.n = implied_force(problem, shape, span.begin + mesh.s[i]);
    }
    states.push_back(state);
  }
  return states;
}

/// Returns states of a whole rod: the moment is that of the grips, the loads and the weight beyond.
std::vector<RodState> states_by_balance(const RodSpan& span, const Problem& problem,
                                        const Equilibrium& shape, const RodMesh& mesh) {
  // Parts per interval for the integration of moments.
  constexpr Eigen::Index parts_per_interval = 8;
  const Eigen::Index count = parts_per_interval * mesh.intervals();
  Eigen::VectorXd s(count + 1);
  for (Eigen::Index k = 0; k <= count; ++k) {
    const Eigen::Index i = std::min(k / parts_per_interval, mesh.intervals() - 1);
    s[k] = mesh.s[i] +
           mesh.width(i) * static_cast<double>(k - parts_per_interval * i) / parts_per_interval;
  }
  const Samples samples = sample_at(span, problem, shape, s);
  const double torque_unit = bending_unit(problem) / problem.length;
  const Eigen::Matrix3Xd r =
      (samples.points.colwise() - problem.grips.front().position) / problem.length;
  std::vector<RodState> states(static_cast<std::size_t>(mesh.s.size()));
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  for (Eigen::Index k = count; k >= 0; --k) {
    if (k % parts_per_interval == 0) {
      RodState& state = states[static_cast<std::size_t>(k / parts_per_interval)];
      const Eigen::Vector3d t = samples.tangents.col(k).normalized();
      state.r = r.col(k);
      state.R =
          frame_along(t, samples.d1.cols() > 0 ? samples.d1.col(k).eval() : t.unitOrthogonal());
      state.m = m;
      if (k < count) state.n = implied_force(problem, shape, s[k]);
      for (const RodSpan::Hold& hold : span.holds) {
        if (hold.at == s[k]) m += shape.grips[hold.grip].torque / torque_unit;
      }
      m += mesh.couple.col(k / parts_per_interval) +
           state.R * mesh.follower_couple.col(k / parts_per_interval);
    }
    if (k == 0) break;
    m -= implied_force(problem, shape, (s[k - 1] + s[k]) / 2)
             .cross(Eigen::Vector3d(r.col(k) - r.col(k - 1)));
  }
  return states;
}

}  // namespace

Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape, double s) {
  const double at = s * problem.length * (1 + 1e-12);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  for (const RodPart& part : rod_parts(problem)) {
    const double on = std::max(0.0, std::min(part.end, s * problem.length) - part.begin);
    n -= on * (part.weight_per_length + on / 2 * part.weight_slope);
  }
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    if (problem.grips[i].at <= at) n -= shape.grips[i].force;
  }
  for (const Load& load : problem.loads) {
    if (load.at <= at) n -= load.force;
  }
  return n * problem.length * problem.length / bending_unit(problem);
}

SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem, const Equilibrium& shape,
                            double tolerance, const Deadline& deadline) {
  check_load(span);
  require(span.round() || !span.clamps.empty(), "solve_exact",
          "number of clamps of a rod with material directors and a start", 0,
          ">= 1, because a start has no frames");
  const double torque_unit = bending_unit(problem) / problem.length;
  const double b = least_bending_stiffness(span);
  double force = total_load(span) / b;
  for (const Reaction& grip : shape.grips) {
    force = std::max(force, grip.force.norm() * problem.length / torque_unit / b);
  }
  const TwistedPart* twisted = twist_of(span, problem, shape);
  const double torque = twisted == nullptr ? 0 : twisted->torque / torque_unit;
  if (span.round()) force = std::max(force, torque * torque / (b * b));
  const RodMesh mesh = make_mesh(span, resolving_interval(span, std::min(force, largest_force)));
  std::vector<RodState> start = span.round()
                                    ? states_by_curvature(span, problem, shape, mesh, torque)
                                    : states_by_balance(span, problem, shape, mesh);
  ShootingOptions options{.tolerance = tolerance, .deadline = deadline};
  const std::vector<double> begin = {0};
  if (span.round() || shape.sample(begin).d1.cols() == 0) {
    carry_frames(span, mesh, tolerance, start);
  }
  if (!span.round() || twisted != nullptr) {
    return shoot_span(span, mesh, std::move(start), held_frames(span), options);
  }
  const RodSpan released = without_frames(span);
  if (out_of_plane(span, start) < plane_tolerance) options.motion = Motion::in_plane;
  SpanEquilibrium equilibrium = shoot_span(released, mesh_at(released, mesh.s), std::move(start),
                                           released_frames(released), options);
  return span.twisted() ? twist_span(span, equilibrium, tolerance, deadline) : equilibrium;
}

}  // namespace dlo::energy_model
