#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/spin.hpp"
#include "shooting/continuation.hpp"

namespace dlo::energy_model {
namespace {

constexpr int most_flow_steps = 200;
// Maximum number of Newton iterations; the method starts near a solution.
constexpr int flow_iterations = 10;
// Duration of the first step, in the rod's units: the rod bends in about 1 / 40.
constexpr double first_duration = 0.01;
constexpr double shortest = 1e-8;              // duration of the shortest step
constexpr double longest = 1e8;                // duration of the longest step
constexpr double largest_flow_rotation = 0.4;  // largest rotation of a tangent in one step [rad]
// Rotation in a step below which the next step is longer [rad].
constexpr double small_flow_rotation = 0.1;
// Rotation in a step of at least settled_duration at which the flow ends [rad].
constexpr double final_flow_rotation = 3e-3;
constexpr double settled_duration = 0.1;  // several times the relaxation time of most modes
constexpr double flow_departure = 0.1;    // largest change of a tangent when a saddle is left [rad]
constexpr int most_flow_departures = 6;
// Steps of constant duration after a failed one, which costs as much as ten others.
constexpr int steps_after_failure = 3;

/// Returns the largest change of a tangent; for a rod that is not round also of d1.
double largest_rotation(const RodSpan& span, const std::vector<Eigen::Matrix3d>& a,
                        const std::vector<Eigen::Matrix3d>& b) {
  double widest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Matrix3d change = a[i] - b[i];
    widest = std::max(widest, change.col(2).norm());
    if (!span.round()) widest = std::max(widest, change.col(0).norm());
  }
  return widest;
}

std::vector<Eigen::Matrix3d> frames_displaced_from(const SpanEquilibrium& saddle,
                                                   double departure) {
  const Eigen::Matrix3Xd spins = departure * saddle.stability.spin_at(saddle.s);
  std::vector<Eigen::Matrix3d> frames = frames_of(saddle.nodes);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = from_rotation_vector(spins.col(static_cast<Eigen::Index>(i))) * frames[i];
  }
  return frames;
}

/// Returns a mesh whose nodes are pulled to the directions of `aim`, for a step of this duration.
RodMesh with_proximal_pull(const RodSpan& span, RodMesh mesh,
                           const std::vector<Eigen::Matrix3d>& aim, double duration) {
  for (Eigen::Index i = 1; i < mesh.intervals(); ++i) {
    const double pull = (mesh.s[i + 1] - mesh.s[i - 1]) / (2 * duration);
    const Eigen::Matrix3d& R = aim[static_cast<std::size_t>(i)];
    mesh.tangent_force.col(i) = pull * R.col(2);
    if (!span.round()) mesh.d1_force.col(i) = pull * R.col(0);
  }
  return mesh;
}

}  // namespace

SpanEquilibrium follow_gradient(const RodSpan& span, const RodMesh& mesh,
                                std::vector<RodState> start, std::vector<Eigen::Matrix3d> aim,
                                const ClampFrames& frames, const ShootingOptions& options) {
  SpanEquilibrium failed;
  failed.message = "the gradient flow did not converge";
  ShootingOptions step = options;
  step.max_iterations = flow_iterations;
  double duration = first_duration;
  int departures = 0;
  int wait = 0;  // number of steps before the next longer one
  for (int k = 0; k < most_flow_steps && duration > shortest; ++k) {
    if (options.deadline.passed()) {
      failed.message = to_string(SolveStatus::time_limit);
      break;
    }
    SpanEquilibrium result =
        close_span(span, with_proximal_pull(span, mesh, aim, duration), start, frames, step);
    failed.integrations += result.integrations;
    std::vector<Eigen::Matrix3d> reached = frames_of(result.nodes);
    const double turn = largest_rotation(span, reached, aim);
    if (!result.converged || turn > largest_flow_rotation) {
      duration /= 4;
      wait = steps_after_failure;
      continue;
    }
    --wait;
    start = std::move(result.nodes);
    aim = std::move(reached);
    if (turn < final_flow_rotation && duration > settled_duration) {
      SpanEquilibrium equilibrium = shoot_span(span, mesh, start, frames, options);
      equilibrium.integrations += failed.integrations;
      failed.integrations = equilibrium.integrations;
      const bool near =
          equilibrium.converged && equilibrium.s.size() == mesh.s.size() &&
          largest_rotation(span, frames_of(equilibrium.nodes), aim) < largest_flow_rotation;
      if (near && equilibrium.stable()) return equilibrium;
      if (near && equilibrium.stability.s.size() > 0 && ++departures <= most_flow_departures) {
        start = equilibrium.nodes;
        aim = frames_displaced_from(equilibrium, flow_departure);
        duration = first_duration;
        continue;
      }
    }
    if (turn < small_flow_rotation && wait < 0)
      duration = std::min(longest, duration * (turn < final_flow_rotation ? 10 : 3));
  }
  return failed;
}

SpanEquilibrium leave_saddle(const RodSpan& span, const SpanEquilibrium& saddle,
                             const ShootingOptions& options) {
  SpanEquilibrium failed;
  failed.message = "the unstable mode is unknown";
  if (saddle.stability.s.size() == 0) return failed;
  const RodMesh mesh = mesh_at(span, saddle.s);
  for (const double side : {1.0, -1.0}) {
    SpanEquilibrium left = follow_gradient(span, mesh, saddle.nodes,
                                           frames_displaced_from(saddle, side * flow_departure),
                                           saddle.frames, options);
    if (left.converged || options.deadline.passed()) return left;
    failed = std::move(left);
  }
  return failed;
}

}  // namespace dlo::energy_model
