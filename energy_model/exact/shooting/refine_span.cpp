#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "problem/rod_law.hpp"
#include "shooting/continuation.hpp"
#include "shooting/span_search.hpp"

namespace dlo::energy_model {
namespace {

constexpr double largest_force = 1e6;  // largest force over b that the first mesh resolves
// Component of the tangents normal to the plane up to which a shape is treated as planar.
constexpr double start_plane_tolerance = 1e-6;
// Difference of equal arc lengths [l].
constexpr double same_arc_length = 1e-9;
// Distance before and behind a point over which the rotation of d1 is measured [l].
constexpr double twist_step = 1e-4;

/// Returns the torque of the part of a shape that is twisted at an arc length (over l) [EI/l];
/// std::nullopt if it is not twisted there.
std::optional<double> torque_at(const Problem& problem, const Equilibrium& shape, double s) {
  const double at = s * problem.length;
  for (const TwistedPart& part : shape.twists) {
    if (part.begin < at && at < part.end) {
      return part.torque * problem.length / bending_unit(problem);
    }
  }
  return std::nullopt;
}

/// Returns the force of the part beyond the arc length s (over l) on the part before, just after s,
/// that the actions of a shape's grips and contacts imply [EI/l^2].
Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape, double s) {
  const double at = (s + same_arc_length) * problem.length;
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
  for (const ContactPart& part : shape.contacts) {
    if (part.end <= at) n -= part.force;
  }
  return n * problem.length * problem.length / bending_unit(problem);
}

}  // namespace

std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh, const Problem& problem,
                                const Equilibrium& shape, double behind, double tolerance) {
  const auto place = [&](double s, double offset) {
    return std::clamp(span.begin + s + offset, 0.0, 1.0);
  };
  const auto sample_at = [&](double offset) {
    std::vector<double> at;
    for (const double s : mesh.s) at.push_back(place(s, offset) * problem.length);
    return shape.sample(at);
  };
  const Samples here = sample_at(behind);
  const bool has_d1 = !span.round() && here.d1.cols() > 0;
  std::vector<RodState> states(static_cast<std::size_t>(mesh.s.size()));
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState& state = states[static_cast<std::size_t>(i)];
    const Eigen::Vector3d t = here.tangents.col(i).normalized();
    state.r = (here.points.col(i) - problem.grips.front().position) / problem.length;
    state.R = frame_along(t, has_d1 ? Eigen::Vector3d(here.d1.col(i)) : t.unitOrthogonal());
    if (i == mesh.intervals()) break;
    const double s = span.begin + mesh.s[i];
    const Eigen::Vector3d curvature = problem.length * here.curvature.col(i);
    state.m = mesh.section_of(i).bending * t.cross(curvature) +
              torque_at(problem, shape, s + behind).value_or(0) * t;
    state.n = implied_force(problem, shape, s);
  }
  if (!has_d1) carry_frames(span, mesh, tolerance, states);
  if (span.round()) return states;
  const Samples before = has_d1 ? sample_at(-twist_step) : here;
  const Samples after = has_d1 ? sample_at(twist_step) : here;
  for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
    RodState& state = states[static_cast<std::size_t>(i)];
    const RodSection& section = mesh.section_of(i);
    const double s = mesh.s[i];
    const Eigen::Vector3d curvature = problem.length * here.curvature.col(i);
    Eigen::Vector3d u(-curvature.dot(state.R.col(1)), curvature.dot(state.R.col(0)), 0);
    if (span.natural) u -= section.natural(span.natural, s);
    u.z() = state.m.dot(state.t()) / section.torsion;
    if (has_d1) {
      const double width = place(s, twist_step) - place(s, -twist_step);
      u.z() = (after.d1.col(i) - before.d1.col(i)).dot(state.R.col(1)) / width;
      if (span.natural) u.z() -= section.natural(span.natural, s).z();
    }
    state.m = state.R * section.stiffness().cwiseProduct(u);
  }
  return states;
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
  const std::optional<double> torque =
      span.twisted() ? torque_at(problem, shape, span.begin + span.length / 2) : std::nullopt;
  if (span.round()) force = std::max(force, std::pow(torque.value_or(0) / b, 2));
  const RodMesh mesh = make_mesh(span, resolving_interval(span, std::min(force, largest_force)));
  constexpr double behind = 1e-12;
  std::vector<RodState> start = states_of(span, mesh, problem, shape, behind, tolerance);
  ShootingOptions options{.tolerance = tolerance, .deadline = deadline};
  if (!span.round() || torque) {
    return shoot_span(span, mesh, std::move(start), held_frames(span), options);
  }
  const RodSpan released = without_frames(span);
  if (out_of_plane(span, start) < start_plane_tolerance) options.motion = Motion::in_plane;
  SpanEquilibrium equilibrium = shoot_span(released, mesh_at(released, mesh.s), std::move(start),
                                           released_frames(released), options);
  return span.twisted() ? twist_span(span, equilibrium, tolerance, deadline) : equilibrium;
}

}  // namespace dlo::energy_model
