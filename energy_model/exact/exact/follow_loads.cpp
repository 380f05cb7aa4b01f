#include "exact/follow_loads.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/spin.hpp"
#include "dlo/energy_model/status.hpp"

namespace dlo::energy_model {
namespace {

constexpr double first_load_step = 0.125;  // first step, as a share of the loads
// Shortest step, as a share of the loads; below it the continuation fails.
constexpr double least_load_step = 1e-4;
// Longest step, as a share of the loads: at least two steps are taken.
constexpr double longest_load_step = 0.5;
// Largest rotation of a tangent from its prediction [rad].
constexpr double largest_correction = 0.5;
// Rotation from the prediction below which the next step is twice as long [rad].
constexpr double small_correction = 0.1;
// Local error of the integrator before the full loads are applied.
constexpr double path_tolerance = 1e-10;
// Maximum number of Newton iterations; the method starts near a solution.
constexpr int path_iterations = 12;

/// A point of the solution branch.
struct Loaded {
  double factor = 0;
  SpanEquilibrium equilibrium;
};

std::vector<RodState> path_states_on(const RodSpan& span, const SpanEquilibrium& equilibrium,
                                     const Eigen::VectorXd& s) {
  std::vector<RodState> states = states_at(equilibrium, span, {s.begin(), s.end()}, path_tolerance);
  states.back().n.setZero();
  states.back().m.setZero();
  return states;
}

/// Returns the prediction of a secant through two points of the branch, at the nodes of a mesh.
std::vector<RodState> predicted_states(const RodSpan& span, const std::optional<Loaded>& before,
                                       const Loaded& now, double factor, const Eigen::VectorXd& s) {
  std::vector<RodState> states = path_states_on(loaded_by(span, now.factor), now.equilibrium, s);
  if (!before) return states;
  const std::vector<RodState> earlier =
      path_states_on(loaded_by(span, before->factor), before->equilibrium, s);
  const double ratio = (factor - now.factor) / (now.factor - before->factor);
  for (std::size_t i = 0; i < states.size(); ++i) {
    RodState& state = states[i];
    const Eigen::AngleAxisd turned(Eigen::Matrix3d(state.R * earlier[i].R.transpose()));
    state.r += ratio * (state.r - earlier[i].r);
    state.R = from_rotation_vector(ratio * turned.angle() * turned.axis()) * state.R;
    state.m += ratio * (state.m - earlier[i].m);
    state.n += ratio * (state.n - earlier[i].n);
  }
  return states;
}

double turn_between(const std::vector<RodState>& a, const std::vector<RodState>& b) {
  double turn = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    turn = std::max(turn, std::atan2(a[i].t().cross(b[i].t()).norm(), a[i].t().dot(b[i].t())));
  }
  return turn;
}

bool keeps_to_plane(const RodSpan& span, const SpanEquilibrium& unloaded) {
  constexpr double flat = 1e-9;
  if (!span.plane || !span.round()) return false;
  const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y);
  return (normal.transpose() * tangents_of(unloaded.nodes)).cwiseAbs().maxCoeff() < flat;
}

}  // namespace

SpanEquilibrium follow_loads(const RodSpan& span, const SpanEquilibrium& unloaded, double tolerance,
                             const Deadline& deadline) {
  ShootingOptions options{
      .tolerance = std::max(tolerance, path_tolerance),
      .motion = keeps_to_plane(span, unloaded) ? Motion::in_plane : Motion::in_space,
      .max_iterations = path_iterations,
      .deadline = deadline};
  std::optional<Loaded> before;
  Loaded now{0, unloaded};
  int shots = unloaded.shots;
  double step = first_load_step;
  SpanEquilibrium result;
  while (now.factor < 1 && step > least_load_step && !deadline.passed()) {
    const double factor = 1 - now.factor < 1.5 * step ? 1 : now.factor + step;
    const RodSpan loaded = loaded_by(span, factor);
    RodMesh mesh = mesh_at(loaded, now.equilibrium.s);
    const double force = bending_force(span, now.equilibrium.nodes);
    if (longest_of(mesh) * std::sqrt(force) > largest_growth) {
      mesh = make_mesh(loaded, longest_interval(loaded, force));
    }
    const std::vector<RodState> start = predicted_states(span, before, now, factor, mesh.s);
    Loaded next{factor, close_span(loaded, mesh, start, unloaded.frames, options)};
    shots += next.equilibrium.shots;
    const double turn =
        next.equilibrium.converged ? turn_between(start, next.equilibrium.nodes) : INFINITY;
    if (turn > largest_correction) {
      step = (factor - now.factor) / 2;
      continue;
    }
    step = std::min(turn < small_correction ? 2 * step : step, longest_load_step);
    before = std::exchange(now, std::move(next));
  }
  if (now.factor < 1) {
    result.message =
        deadline.passed()
            ? std::string(to_string(SolveStatus::time_limit))
            : "continuation from the equilibrium under the loads with a potential ends at " +
                  std::to_string(now.factor) +
                  " of the loads without a potential; other equilibria are not searched for";
  } else {
    options.tolerance = tolerance;
    result = shoot_span(span, mesh_at(span, now.equilibrium.s), now.equilibrium.nodes,
                        unloaded.frames, options);
  }
  result.shots += shots;
  return result;
}

}  // namespace dlo::energy_model
