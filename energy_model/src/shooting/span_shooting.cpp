#include "shooting/span_shooting.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/found_equilibria.hpp"
#include "base/require.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "problem/rod_law.hpp"
#include "shooting/gradient_flow.hpp"
#include "shooting/span_twist.hpp"

namespace dlo::energy_model {
namespace {

constexpr double largest_load = 1e6;      // of weight and loads, in EI/l^2
constexpr double in_plane = 1e-6;         // of tangents
constexpr double same_tangents = 1e-6;    // of two equilibria
constexpr std::size_t most_descents = 6;  // polygons that are shot from if one leads to a minimum
constexpr int most_saddles_left = 8;      // saddles that are left
constexpr double departure = 0.3;         // largest change of a tangent when a saddle is left
constexpr int finer_polygons = 2;         // after a shot that has failed
constexpr Eigen::Index most_intervals = 1000;  // of a polygon that is made finer
constexpr int search_iterations = 30;     // of Newton's method, which takes 6 to 12 near a minimum
constexpr double start_tolerance = 1e-6;  // of the integrator along a polygon
constexpr double polygons_share = 0.5;    // of the time that is left

void check_load(const RodSpan& span) {
  const double load = total_load(span) / softest(span);
  require(load <= largest_load, "solve_exact", "sum of weight and loads over EI/l^2", load,
          "<= 1e6");
}

bool stays_in_plane(const RodSpan& span, const Eigen::Matrix3Xd& tangents, double tolerance) {
  if (!span.plane) return false;
  const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y);
  return (normal.transpose() * tangents).cwiseAbs().maxCoeff() < tolerance;
}

bool same(const RodSpan& span, const SpanEquilibrium& a, const SpanEquilibrium& b) {
  constexpr double coarse = 1e-10;
  const Eigen::VectorXd probes = Eigen::VectorXd::LinSpaced(33, 0, span.length);
  const std::vector<double> s(probes.begin(), probes.end());
  const Eigen::Matrix3Xd difference =
      tangents_of(states_at(a, span, s, coarse)) - tangents_of(states_at(b, span, s, coarse));
  return difference.colwise().norm().maxCoeff() < same_tangents;
}

/// Tangents of a polygon on another mesh, constant along its intervals.
Eigen::Matrix3Xd tangents_on(const RodMesh& from, const Eigen::Matrix3Xd& tangents,
                             const RodMesh& to) {
  Eigen::Matrix3Xd result(3, to.intervals());
  for (Eigen::Index i = 0; i < to.intervals(); ++i) {
    const double middle = (to.s[i] + to.s[i + 1]) / 2;
    const Eigen::Index after =
        std::upper_bound(from.s.begin(), from.s.end(), middle) - from.s.begin();
    result.col(i) = tangents.col(std::clamp<Eigen::Index>(after - 1, 0, from.intervals() - 1));
  }
  return result;
}

/// A polygon to shoot from.
struct PolygonStart {
  RelaxedPolygon polygon;
  bool planar;
};

/// Minima of polygons, lowest first. @return false if the deadline has cut the search short
bool polygon_starts(const RodSpan& span, const RodMesh& mesh, const Deadline& deadline,
                    std::vector<PolygonStart>& starts) {
  bool complete = true;
  const auto search = [&](bool planar) {
    PolygonMinima minima = polygon_minima(span, mesh, planar, deadline);
    complete = complete && minima.complete;
    constexpr double nearly_in_plane = 0.01;
    for (RelaxedPolygon& polygon : minima.found) {
      if (!planar && stays_in_plane(span, polygon.tangents, nearly_in_plane)) continue;
      starts.push_back({std::move(polygon), planar});
    }
  };
  if (span.plane) search(true);
  search(false);
  std::stable_sort(starts.begin(), starts.end(), [](const PolygonStart& a, const PolygonStart& b) {
    return a.polygon.energy < b.polygon.energy;
  });
  return complete;
}

/// What search_span() has found so far.
class SpanSearch {
 public:
  SpanSearch(const RodSpan& span, double tolerance, const Deadline& deadline)
      : span_(span),
        mesh_(make_mesh(span, longest_interval(span, total_load(span) / softest(span)))),
        tolerance_(tolerance),
        deadline_(deadline) {}

  SpanSearchResult run() {
    std::vector<PolygonStart> starts;
    const Deadline polygons(polygons_share * deadline_.remaining());
    bool complete = polygon_starts(span_, mesh_, polygons, starts);
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (i >= (std::isfinite(lowest_stable_energy(found_)) ? most_descents : 2 * most_descents))
        break;
      if (deadline_.passed()) break;
      descend(starts[i]);
    }
    leave_saddles();
    complete = complete && !deadline_.passed();
    if (found_.empty()) {
      if (!complete) failed_.message = to_string(SolveStatus::time_limit);
      found_.push_back(std::move(failed_));
    }
    sort_by_stability(found_);
    found_.front().shots = shots_;
    return {std::move(found_), complete};
  }

 private:
  SpanEquilibrium shoot_from(const RodMesh& mesh, const RelaxedPolygon& polygon, bool planar) {
    std::vector<RodState> start = states_of(span_, mesh, polygon);
    carry_frames(span_, mesh, start_tolerance, start);
    SpanEquilibrium equilibrium = shoot_span(span_, mesh, std::move(start), released_frames(span_),
                                             {.tolerance = tolerance_,
                                              .planar = planar,
                                              .max_iterations = search_iterations,
                                              .deadline = deadline_});
    shots_ += equilibrium.shots;
    return equilibrium;
  }

  void descend(const PolygonStart& start) {
    RodMesh mesh = mesh_;
    RelaxedPolygon polygon = start.polygon;
    const auto longest_of = [&] {
      return (mesh.s.tail(mesh.intervals()) - mesh.s.head(mesh.intervals())).maxCoeff();
    };
    const auto refine = [&](double longest) {
      RodMesh finer = make_mesh(span_, longest);
      polygon = relax_polygon(span_, finer, tangents_on(mesh, polygon.tangents, finer),
                              start.planar, deadline_);
      mesh = std::move(finer);
    };
    // Under a large reaction the coarse polygon is not near enough.
    const double force = polygon.force.colwise().norm().maxCoeff() / softest(span_);
    const double resolved = std::max(1 / std::sqrt(std::max(force, 1.0)),
                                     span_.length / static_cast<double>(most_intervals));
    if (longest_of() > 1.5 * resolved) refine(resolved);
    SpanEquilibrium equilibrium = shoot_from(mesh, polygon, start.planar);
    for (int level = 0; level < finer_polygons && !equilibrium.converged; ++level) {
      if (deadline_.passed() || mesh.intervals() > most_intervals / 3) break;
      refine(longest_of() / 3);
      equilibrium = shoot_from(mesh, polygon, start.planar);
    }
    if (!equilibrium.converged) {
      failed_ = std::move(equilibrium);
      return;
    }
    const bool known = std::any_of(found_.begin(), found_.end(), [&](const auto& other) {
      return same(span_, other, equilibrium);
    });
    if (!known) found_.push_back(std::move(equilibrium));
  }

  /// An unstable equilibrium below all stable ones shows that a minimum has been missed.
  void leave_saddles() {
    std::vector<double> energies;  // of those that have been left
    for (int i = 0; i < most_saddles_left && !deadline_.passed(); ++i) {
      const SpanEquilibrium* lowest = missed_minimum(found_, energies);
      if (lowest == nullptr) return;
      energies.push_back(lowest->energy.total());
      const SpanEquilibrium saddle = *lowest;
      for (const double side : {1.0, -1.0}) leave(saddle, side * departure);
    }
  }

  /// Relaxes the polygon from beside a saddle.
  void leave(const SpanEquilibrium& saddle, double amplitude) {
    if (saddle.stability.s.size() == 0) return;
    const Eigen::VectorXd middles =
        (mesh_.s.head(mesh_.intervals()) + mesh_.s.tail(mesh_.intervals())) / 2;
    Eigen::Matrix3Xd tangents =
        tangents_of(states_at(saddle, span_, {middles.begin(), middles.end()}, tolerance_)) +
        amplitude * tangent_mode(span_, saddle, middles);
    tangents.colwise().normalize();
    const bool planar = stays_in_plane(span_, tangents, in_plane);
    RelaxedPolygon polygon = relax_polygon(span_, mesh_, std::move(tangents), planar, deadline_);
    descend({std::move(polygon), planar});
  }

  const RodSpan& span_;
  RodMesh mesh_;
  double tolerance_;
  Deadline deadline_;
  std::vector<SpanEquilibrium> found_;
  SpanEquilibrium failed_;
  int shots_ = 0;
};

/// What a shape says of the twist of a span that holds some; null for nothing.
const TwistedPart* twist_of(const RodSpan& span, const Problem& problem, const Equilibrium& shape) {
  if (!span.twisted()) return nullptr;
  const double middle = (span.begin + span.length / 2) * problem.length;
  const auto found = std::find_if(shape.twists.begin(), shape.twists.end(), [&](const auto& part) {
    return part.begin < middle && middle < part.end;
  });
  return found == shape.twists.end() ? nullptr : &*found;
}

RodSpan without_twist(RodSpan span) {
  for (RodSpan::Clamp& clamp : span.clamps) clamp.frame.reset();
  return span;
}

}  // namespace

SpanSearchResult search_span(const RodSpan& span, double tolerance, const Deadline& deadline) {
  check_load(span);
  return SpanSearch(span, tolerance, deadline).run();
}

Eigen::Vector3d implied_force(const Problem& problem, const Equilibrium& shape, double s) {
  const double at = s * problem.length * (1 + 1e-12);
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  for (const Section& part : rod_parts(problem)) {
    const double until = std::min(part.end, s * problem.length);
    n -= std::max(0.0, until - part.begin) * part.weight_per_length;
  }
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    if (problem.grips[i].at <= at) n -= shape.grips[i].force;
  }
  for (const Load& load : problem.loads) {
    if (load.at <= at) n -= load.force;
  }
  return n * problem.length * problem.length / bending_unit(problem);
}

SpanSearchResult search_twisted_span(const RodSpan& span, double tolerance,
                                     const Deadline& deadline) {
  const RodSpan plain = without_twist(span);
  SpanSearchResult search = search_span(plain, tolerance, deadline);
  SpanEquilibrium twisted = twist_span(span, search.found.front(), tolerance, deadline);
  return {{std::move(twisted)}, search.complete && !deadline.passed()};
}

SpanEquilibrium refine_span(const RodSpan& span, const Problem& problem, const Equilibrium& shape,
                            double tolerance, const Deadline& deadline) {
  check_load(span);
  double force = total_load(span);
  for (const Reaction& grip : shape.grips) {
    const double unit = bending_unit(problem) / (problem.length * problem.length);
    force = std::max(force, grip.force.norm() / unit);
  }
  const TwistedPart* twisted = twist_of(span, problem, shape);
  const double torque =
      twisted == nullptr ? 0 : twisted->torque * problem.length / bending_unit(problem);
  const double b = softest(span);
  force = std::max(force / b, torque * torque / (b * b));
  const RodMesh mesh = make_mesh(span, longest_interval(span, std::min(force, largest_load)));
  std::vector<double> arc_lengths;
  for (const double s : mesh.s) {
    arc_lengths.push_back(std::min((span.begin + s) * problem.length, problem.length));
  }
  // At a clamp the curvature jumps: that of this side is wanted.
  constexpr double inside = 1e-12;
  if (span.begin > 0) arc_lengths.front() += inside * problem.length;
  const Samples samples = shape.sample(arc_lengths);
  std::vector<RodState> start;
  for (Eigen::Index i = 0; i < mesh.s.size(); ++i) {
    RodState state;
    const Eigen::Vector3d t = samples.tangents.col(i);
    state.r = (samples.points.col(i) - problem.grips.front().position) / problem.length;
    state.R = frame_of(t.unitOrthogonal(), t);
    if (i < mesh.intervals()) {
      const Eigen::Vector3d curvature = samples.curvature.col(i) * problem.length;
      state.m = mesh.section_of(i).bending * t.cross(curvature) + torque * t;
      state.n = implied_force(problem, shape, span.begin + mesh.s[i]);
    }
    start.push_back(state);
  }
  carry_frames(span, mesh, tolerance, start);
  if (twisted != nullptr) return refine_twisted(span, mesh, std::move(start), tolerance, deadline);
  const RodSpan plain = without_twist(span);
  SpanEquilibrium equilibrium =
      shoot_span(plain, mesh_at(plain, mesh.s), std::move(start), released_frames(plain),
                 {.tolerance = tolerance,
                  .planar = stays_in_plane(span, samples.tangents, in_plane),
                  .deadline = deadline});
  return span.twisted() ? twist_span(span, equilibrium, tolerance, deadline) : equilibrium;
}

}  // namespace dlo::energy_model
