#include "span_shooting.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "boundary_value.hpp"
#include "relaxed_polygon.hpp"
#include "require.hpp"

namespace dlo::energy_model {
namespace {

constexpr double largest_load = 1e6;      // of weight and loads, in EI/l^2
constexpr double largest_growth = 3;      // of an interval: its length times |n|^(1/2)
constexpr double in_plane = 1e-6;         // of tangents
constexpr double same_tangents = 1e-6;    // of two equilibria
constexpr std::size_t most_descents = 6;  // polygons that are shot from

/// Intervals that resolve boundary layers under a force, and the bends of a span without any.
double longest_interval(const RodSpan& span, double force) {
  return std::min(span.length / 16, 1 / std::sqrt(std::max(force, 1.0)));
}

void check_load(const RodSpan& span) {
  const double load = total_load(span);
  require(load <= largest_load, "solve_exact", "sum of weight and loads over EI/l^2", load,
          "<= 1e6");
}

double largest_force(const std::vector<RodState>& nodes) {
  double force = 0;
  for (const RodState& node : nodes) force = std::max({force, node.n.norm(), node.v.squaredNorm()});
  return force;
}

bool stays_in_plane(const RodSpan& span, const Eigen::Matrix3Xd& tangents, double tolerance) {
  if (!span.plane) return false;
  const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y);
  return (normal.transpose() * tangents).cwiseAbs().maxCoeff() < tolerance;
}

void add_energies(const RodSpan& span, const RodMesh& mesh, double tolerance,
                  SpanEquilibrium& equilibrium) {
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state = equilibrium.nodes[static_cast<std::size_t>(i)];
    equilibrium.energy.load -= mesh.load.col(i).dot(state.r);
    if (i == mesh.intervals()) break;
    RodIntegrals integrals;
    equilibrium.converged =
        equilibrium.converged &&
        follow_rod(span.weight, mesh.s[i + 1] - mesh.s[i], tolerance, state, integrals);
    equilibrium.energy.bending += integrals.bending;
    equilibrium.energy.gravity += integrals.gravity;
  }
}

/// Shoots, on a finer mesh once more if the force turns out to be large.
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
    const double force = largest_force(equilibrium.nodes);
    const double longest =
        (mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())).maxCoeff();
    if (!result.converged || longest * std::sqrt(force) <= largest_growth) break;
    mesh = make_mesh(span, longest_interval(span, force));
    start.clear();
    for (const double s : mesh.s) {
      start.push_back(state_at(equilibrium, span.weight, s, options.tolerance));
    }
    start.back().n.setZero();
  }
  if (equilibrium.converged) add_energies(span, mesh, options.tolerance, equilibrium);
  return equilibrium;
}

/// Force after the arc length s that the results of a solver imply, in units of the rod.
Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape, double s) {
  const double at = s * problem.length * (1 + 1e-12);
  Eigen::Vector3d n = -s * problem.length * problem.weight_per_length;
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    if (problem.grips[i].at <= at) n -= shape.grips[i].force;
  }
  for (const Load& load : problem.loads) {
    if (load.at <= at) n -= load.force;
  }
  return n * problem.length * problem.length / problem.bending_stiffness;
}

bool same(const SpanEquilibrium& a, const SpanEquilibrium& b) {
  if (a.nodes.size() != b.nodes.size()) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if ((a.nodes[i].t - b.nodes[i].t).norm() > same_tangents) return false;
  }
  return true;
}

}  // namespace

std::vector<SpanEquilibrium> search_span(const RodSpan& span, double tolerance) {
  check_load(span);
  const RodMesh mesh = make_mesh(span, longest_interval(span, total_load(span)));
  struct Start {
    RelaxedPolygon polygon;
    bool planar;
  };
  std::vector<Start> starts;
  if (span.plane) {
    for (RelaxedPolygon& polygon : polygon_minima(span, mesh, true)) {
      starts.push_back({std::move(polygon), true});
    }
  }
  constexpr double nearly_in_plane = 0.01;
  for (RelaxedPolygon& polygon : polygon_minima(span, mesh, false)) {
    if (stays_in_plane(span, polygon.tangents, nearly_in_plane)) continue;
    starts.push_back({std::move(polygon), false});
  }
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return a.polygon.energy < b.polygon.energy;
  });
  std::vector<SpanEquilibrium> found;
  SpanEquilibrium failed;
  int shots = 0;
  for (std::size_t i = 0; i < std::min(starts.size(), most_descents); ++i) {
    SpanEquilibrium equilibrium = shoot_span(span, mesh, states_of(span, mesh, starts[i].polygon),
                                             {.tolerance = tolerance, .planar = starts[i].planar});
    shots += equilibrium.shots;
    if (!equilibrium.converged) {
      failed = std::move(equilibrium);
      continue;
    }
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const auto& other) { return same(other, equilibrium); });
    if (!known) found.push_back(std::move(equilibrium));
  }
  // Mirror images have the same energy up to rounding and keep their order.
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    const double rounding = 1e-11 * (1 + std::abs(a.energy.total()));
    return a.energy.total() < b.energy.total() - rounding;
  });
  if (found.empty()) found.push_back(std::move(failed));
  found.front().shots = shots;
  return found;
}

SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem, const Equilibrium& shape,
                            double tolerance) {
  check_load(span);
  double force = total_load(span);
  for (const Reaction& grip : shape.grips) {
    const double unit = problem.bending_stiffness / (problem.length * problem.length);
    force = std::max(force, grip.force.norm() / unit);
  }
  const RodMesh mesh = make_mesh(span, longest_interval(span, std::min(force, largest_load)));
  std::vector<double> arc_lengths;
  for (const double s : mesh.s) {
    arc_lengths.push_back(std::min((span.begin + s) * problem.length, problem.length));
  }
  const Samples samples = shape.sample(arc_lengths);
  std::vector<RodState> start;
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state;
    state.r = (samples.points.col(i) - problem.grips.front().position) / problem.length;
    state.t = samples.tangents.col(i);
    state.v = samples.curvature.col(i) * problem.length;
    if (i < mesh.intervals()) state.n = implied_force(problem, shape, span.begin + mesh.s[i]);
    start.push_back(state);
  }
  return shoot_span(
      span, mesh, std::move(start),
      {.tolerance = tolerance, .planar = stays_in_plane(span, samples.tangents, in_plane)});
}

RodState state_at(const SpanEquilibrium& span, const Eigen::Vector3d& weight, double s,
                  double tolerance) {
  const auto last = static_cast<std::ptrdiff_t>(span.nodes.size()) - 2;
  const auto after = std::upper_bound(span.s.begin(), span.s.end(), s) - span.s.begin();
  const std::ptrdiff_t i = std::clamp<std::ptrdiff_t>(after - 1, 0, last);
  if (s >= span.s[i + 1]) return span.nodes.back();
  RodState state = span.nodes[static_cast<std::size_t>(i)];
  RodIntegrals integrals;
  (void)follow_rod(weight, s - span.s[i], tolerance, state, integrals);
  return state;
}

}  // namespace dlo::energy_model
