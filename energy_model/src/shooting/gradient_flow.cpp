#include "shooting/gradient_flow.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dlo::energy_model {
namespace {

constexpr int most_steps = 200;
constexpr int flow_iterations = 10;       // of Newton's method, which starts nearby
constexpr double first_duration = 0.01;   // of a step, in the rod's units: it bends in about 1 / 40
constexpr double shortest = 1e-8;         // step
constexpr double longest = 1e8;           // step
constexpr double most_flow_turn = 0.4;    // of a tangent in one step [rad]
constexpr double small_turn = 0.1;        // that lets the next step be longer [rad]
constexpr double settled_turn = 3e-3;     // turn in a step of at least settled_duration [rad]
constexpr double settled_duration = 0.1;  // several times that of most modes
constexpr double flow_departure = 0.1;    // from a saddle: largest change of a tangent [rad]
constexpr int most_flow_departures = 6;
constexpr int steps_after_failure = 3;  // of equal duration: a failure costs as much as ten of them

double widest_turn(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

/// One step, from nodes near `aim` and to it.
SpanEquilibrium step(const RodSpan& span, RodMesh mesh, const std::vector<RodState>& nodes,
                     const Eigen::Matrix3Xd& aim, double duration, const ClampFrames& frames,
                     ShootingOptions options) {
  for (Eigen::Index i = 1; i < mesh.intervals(); ++i) {
    mesh.pull.col(i) = (mesh.s[i + 1] - mesh.s[i - 1]) / (2 * duration) * aim.col(i);
  }
  options.max_iterations = flow_iterations;
  return close_span(span, mesh, nodes, frames, options);
}

}  // namespace

SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                std::vector<RodState> start, Eigen::Matrix3Xd aim,
                                const ClampFrames& frames, const ShootingOptions& options) {
  SpanEquilibrium failed;
  failed.message = "the gradient flow did not converge";
  double duration = first_duration;
  int departures = 0;
  int wait = 0;  // steps before the next longer one
  for (int k = 0; k < most_steps && duration > shortest; ++k) {
    if (options.deadline.passed()) {
      failed.message = to_string(SolveStatus::time_limit);
      break;
    }
    SpanEquilibrium result = step(span, mesh, start, aim, duration, frames, options);
    failed.shots += result.shots;
    Eigen::Matrix3Xd reached = tangents_of(result.nodes);
    const double turn = widest_turn(reached, aim);
    if (!result.converged || turn > most_flow_turn) {
      duration /= 4;
      wait = steps_after_failure;
      continue;
    }
    --wait;
    start = std::move(result.nodes);
    aim = std::move(reached);
    if (turn < settled_turn && duration > settled_duration) {
      SpanEquilibrium equilibrium = shoot_span(span, mesh, start, frames, options);
      equilibrium.shots += failed.shots;
      failed.shots = equilibrium.shots;
      const bool near = equilibrium.converged && equilibrium.s.size() == mesh.s.size() &&
                        widest_turn(tangents_of(equilibrium.nodes), aim) < most_flow_turn;
      if (near && equilibrium.stable()) return equilibrium;
      if (near && equilibrium.stability.s.size() > 0 && ++departures <= most_flow_departures) {
        start = equilibrium.nodes;
        aim = tangents_of(start) + flow_departure * tangent_mode(span, equilibrium, mesh.s);
        aim.colwise().normalize();
        duration = first_duration;
        continue;
      }
    }
    if (turn < small_turn && wait < 0)
      duration = std::min(longest, duration * (turn < settled_turn ? 10 : 3));
  }
  return failed;
}

Eigen::Matrix3Xd tangent_mode(const RodSpan& span, const SpanEquilibrium& equilibrium,
                              const Eigen::VectorXd& s) {
  constexpr double coarse = 1e-9;
  const Eigen::Matrix3Xd spins = equilibrium.stability.spin_at(s);
  const std::vector<RodState> states = states_at(equilibrium, span, {s.begin(), s.end()}, coarse);
  Eigen::Matrix3Xd changes(3, s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    changes.col(i) = spins.col(i).cross(states[static_cast<std::size_t>(i)].t());
  }
  return changes / std::max(changes.colwise().norm().maxCoeff(), 1e-300);
}

SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                             const ShootingOptions& options) {
  SpanEquilibrium failed;
  failed.message = "its unstable mode is not known";
  if (saddle.stability.s.size() == 0) return failed;
  const RodMesh mesh = mesh_at(span, saddle.s);
  for (const double side : {1.0, -1.0}) {
    Eigen::Matrix3Xd aim =
        tangents_of(saddle.nodes) + side * flow_departure * tangent_mode(span, saddle, mesh.s);
    aim.colwise().normalize();
    SpanEquilibrium left =
        follow_gradient(span, mesh, saddle.nodes, std::move(aim), saddle.frames, options);
    if (left.converged || options.deadline.passed()) return left;
    failed = std::move(left);
  }
  return failed;
}

}  // namespace dlo::energy_model
