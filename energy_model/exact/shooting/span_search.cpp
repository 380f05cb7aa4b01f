#include "shooting/span_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/found_equilibria.hpp"
#include "base/require.hpp"
#include "base/spin.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
#include "shooting/continuation.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;

constexpr double same_directors = 1e-6;  // largest difference of directors of two equal equilibria
// Maximum number of polygons to shoot from if one converges to a minimum.
constexpr std::size_t most_descents = 6;
// Maximum number of polygons to shoot from while none converges to a minimum.
constexpr std::size_t most_without_minimum = 16;
constexpr int most_saddle_departures = 8;  // maximum number of saddles to leave
constexpr double saddle_departure = 0.3;   // largest spin when a saddle is left [rad]
constexpr int finer_polygons = 2;          // number of finer polygons after a shot that has failed
// Maximum number of intervals of a polygon on a finer mesh.
constexpr Eigen::Index most_intervals = 1000;
// Maximum number of Newton iterations; 6 to 12 are usual near a minimum.
constexpr int search_iterations = 30;
constexpr double start_tolerance = 1e-6;  // local error of the integrator along a polygon
constexpr double polygons_share = 0.5;    // share of the remaining time for relaxing polygons
// Largest rotation of a stress-free polygon at a node [rad].
constexpr double largest_node_rotation = 0.3;

/// Whether two equilibria are equal. The frames of a round rod without twist are arbitrary, so that
/// only its tangents are compared.
bool are_equal_equilibria(const RodSpan& span, const SpanEquilibrium& a, const SpanEquilibrium& b) {
  const Eigen::VectorXd probes = Eigen::VectorXd::LinSpaced(33, 0, span.length);
  const std::vector<double> s(probes.begin(), probes.end());
  const std::vector<RodState> first = states_at(a, span, s, coarse_tolerance);
  const std::vector<RodState> second = states_at(b, span, s, coarse_tolerance);
  double distance = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Matrix3d change = first[i].R - second[i].R;
    distance = std::max(distance,
                        span.round() ? change.col(2).norm() : change.colwise().norm().maxCoeff());
  }
  return distance < same_directors;
}

/// Search of search_span() for a span whose frames are released, with the equilibria found so far.
class SpanSearch {
 public:
  SpanSearch(const RodSpan& span, double tolerance, const Deadline& deadline)
      : span_(span),
        mesh_(make_mesh(
            span, resolving_interval(span, total_load(span) / least_bending_stiffness(span)))),
        tolerance_(tolerance),
        deadline_(deadline) {}

  SpanSearchResult run() {
    const Deadline relaxing(polygons_share * deadline_.remaining());
    const PolygonMinima polygons = polygon_minima(span_, mesh_, relaxing);
    for (std::size_t i = 0; i < polygons.found.size() && !deadline_.passed(); ++i) {
      const bool stable = std::isfinite(lowest_stable_energy(found_));
      if (i >= (stable ? most_descents : most_without_minimum)) break;
      descend(polygons.found[i]);
    }
    leave_saddles();
    flow_from_saddle();
    const bool complete = polygons.complete && !deadline_.passed();
    if (found_.empty()) {
      if (!complete) failed_.message = to_string(SolveStatus::time_limit);
      found_.push_back(std::move(failed_));
    }
    sort_by_stability(found_);
    found_.front().integrations = integrations_;
    return {std::move(found_), complete};
  }

 private:
  SpanEquilibrium shoot_from(const RodMesh& mesh, const RelaxedPolygon& polygon) {
    std::vector<RodState> start = states_of(span_, mesh, polygon);
    if (span_.round()) carry_frames(span_, mesh, start_tolerance, start);
    SpanEquilibrium equilibrium =
        shoot_span(span_, mesh, std::move(start), released_frames(span_),
                   {.tolerance = tolerance_,
                    // Whether material directors stay in the plane is decided by a solution in
                    // space.
                    .motion = span_.round() ? polygon.motion : Motion::in_space,
                    .max_iterations = search_iterations,
                    .deadline = deadline_});
    integrations_ += equilibrium.integrations;
    return equilibrium;
  }

  void descend(RelaxedPolygon polygon) {
    RodMesh mesh = mesh_;
    const auto refine = [&](double longest) {
      RodMesh finer = make_mesh(span_, longest);
      polygon = relax_on_mesh(span_, finer, mesh, polygon, deadline_);
      mesh = std::move(finer);
    };
    // Under a large reaction the coarse polygon is not accurate enough.
    const double force = polygon.force.colwise().norm().maxCoeff() / least_bending_stiffness(span_);
    const double resolved = std::max(1 / std::sqrt(std::max(force, 1.0)),
                                     span_.length / static_cast<double>(most_intervals));
    if (longest_of(mesh) > 1.5 * resolved) refine(resolved);
    SpanEquilibrium equilibrium = shoot_from(mesh, polygon);
    for (int level = 0; level < finer_polygons && !equilibrium.converged; ++level) {
      if (deadline_.passed() || mesh.intervals() > most_intervals / 3) break;
      refine(longest_of(mesh) / 3);
      equilibrium = shoot_from(mesh, polygon);
    }
    if (!equilibrium.converged) {
      failed_ = std::move(equilibrium);
      return;
    }
    const bool known = std::any_of(found_.begin(), found_.end(), [&](const auto& other) {
      return are_equal_equilibria(span_, other, equilibrium);
    });
    if (!known) found_.push_back(std::move(equilibrium));
  }

  /// Leaves unstable equilibria below all stable ones, which show that a minimum has been missed.
  void leave_saddles() {
    std::vector<double> energies;  // energies of the saddles that have been left
    for (int i = 0; i < most_saddle_departures && !deadline_.passed(); ++i) {
      const SpanEquilibrium* lowest = saddle_below_minima(found_, energies);
      if (lowest == nullptr) return;
      energies.push_back(lowest->energy.total());
      const SpanEquilibrium saddle = *lowest;
      for (const double side : {1.0, -1.0}) leave(saddle, side * saddle_departure);
    }
  }

  /// Relaxes the polygon from beside a saddle, and shoots from it.
  void leave(const SpanEquilibrium& saddle, double amplitude) {
    if (saddle.stability.s.size() == 0) return;
    const Eigen::VectorXd middles =
        (mesh_.s.head(mesh_.intervals()) + mesh_.s.tail(mesh_.intervals())) / 2;
    const std::vector<RodState> states =
        states_at(saddle, span_, {middles.begin(), middles.end()}, tolerance_);
    const Eigen::Matrix3Xd spins = amplitude * saddle.stability.spin_at(middles);
    std::vector<Quaterniond> frames;
    Motion motion = span_.plane ? Motion::in_plane : Motion::in_space;
    for (Eigen::Index i = 0; i < middles.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      frames.emplace_back(from_rotation_vector(spins.col(i)) * Quaterniond(states[at].R));
      if (!lies_in_plane(frames.back())) motion = Motion::in_space;
    }
    descend(relax_polygon(span_, mesh_, frames, motion, deadline_));
  }

  /// Follows the gradient flow from the lowest saddle if no stable equilibrium is found. A polygon
  /// may return to the saddle, but the gradient flow does not.
  void flow_from_saddle() {
    if (found_.empty() || std::isfinite(lowest_stable_energy(found_))) return;
    sort_by_stability(found_);
    SpanEquilibrium left = leave_saddle(
        span_, found_.front(),
        {.tolerance = tolerance_, .max_iterations = search_iterations, .deadline = deadline_});
    integrations_ += left.integrations;
    if (left.converged) found_.push_back(std::move(left));
  }

  [[nodiscard]] bool lies_in_plane(const Quaterniond& frame) const {
    if (!span_.plane) return false;
    const Eigen::Vector3d out = frame.conjugate() * span_.plane->x.cross(span_.plane->y);
    return std::abs(out.z()) < plane_tolerance &&
           (span_.round() || std::abs(out.x()) < plane_tolerance);
  }

  const RodSpan& span_;
  RodMesh mesh_;
  double tolerance_;
  Deadline deadline_;
  std::vector<SpanEquilibrium> found_;
  SpanEquilibrium failed_;
  int integrations_ = 0;
};

/// Whether two neighbouring grips are at least as far apart as the rod between them is long.
bool is_pulled_straight(const RodSpan& span) {
  for (std::size_t i = 0; i + 1 < span.holds.size(); ++i) {
    const RodSpan::Hold& a = span.holds[i];
    const RodSpan::Hold& b = span.holds[i + 1];
    if ((b.position - a.position).norm() >= (b.at - a.at) * (1 - 1e-12)) return true;
  }
  return false;
}

/// Solves for a rod that stretches, from straight lines between its two or more grips and beyond.
SpanEquilibrium shoot_from_lines(const RodSpan& span, double tolerance, const Deadline& deadline) {
  const std::vector<RodSpan::Hold>& holds = span.holds;
  const double yields = span.parts.front().section.stretch;
  std::vector<Eigen::Vector3d> tangents;
  std::vector<double> strains;
  double largest = total_load(span);
  for (std::size_t i = 0; i + 1 < holds.size(); ++i) {
    const Eigen::Vector3d chord = holds[i + 1].position - holds[i].position;
    tangents.push_back(chord.normalized());
    strains.push_back(chord.norm() / (holds[i + 1].at - holds[i].at) - 1);
    largest = std::max(largest, std::abs(strains.back()) / yields);
  }
  const RodMesh mesh =
      make_mesh(span, resolving_interval(span, largest / least_bending_stiffness(span)));
  std::vector<RodState> start(static_cast<std::size_t>(mesh.s.size()));
  for (Eigen::Index k = 0; k < mesh.s.size(); ++k) {
    std::size_t i = 0;
    while (i + 2 < holds.size() && mesh.s[k] >= holds[i + 1].at) ++i;
    RodState& state = start[static_cast<std::size_t>(k)];
    const double inside = std::clamp(mesh.s[k], holds[i].at, holds[i + 1].at);
    const double distance = (inside - holds[i].at) * (1 + strains[i]) + mesh.s[k] - inside;
    state.r = holds[i].position + distance * tangents[i];
    state.R = frame_along(tangents[i], tangents[i].unitOrthogonal());
    if (inside == mesh.s[k] && inside < holds.back().at) {
      state.n = strains[i] / yields * tangents[i];
    }
  }
  carry_frames(span, mesh, start_tolerance, start);
  return shoot_span(span, mesh, std::move(start), released_frames(span),
                    {.tolerance = tolerance, .deadline = deadline});
}

SpanSearchResult search_without_frames(const RodSpan& span, double tolerance,
                                       const Deadline& deadline) {
  if (span.parts.front().section.stretch == 0) return SpanSearch(span, tolerance, deadline).run();
  if (is_pulled_straight(span)) return {{shoot_from_lines(span, tolerance, deadline)}, true};
  SpanSearchResult search = SpanSearch(with_stretch_share(span, 0), tolerance, deadline).run();
  for (SpanEquilibrium& found : search.found) {
    found = stretch_span(span, found, tolerance, deadline);
  }
  // A rod that would have to bend may be compressed instead.
  if (span.holds.size() > 1) {
    SpanEquilibrium pressed = shoot_from_lines(span, tolerance, deadline);
    const bool known = std::ranges::any_of(search.found, [&](const SpanEquilibrium& other) {
      return other.converged && are_equal_equilibria(span, other, pressed);
    });
    if (pressed.converged && !known) search.found.push_back(std::move(pressed));
  }
  sort_by_stability(search.found);
  return search;
}

}  // namespace

void check_load(const RodSpan& span) {
  const double load = total_load(span) / least_bending_stiffness(span);
  require(load <= 1e6, "solve_exact", "sum of weight and loads, divided by EI/l^2", load, "<= 1e6");
}

double resolving_interval(const RodSpan& span, double force) {
  double longest = longest_interval(span, force);
  for (const Eigen::Vector3d& bend : sample_natural_strains(span, 32)) {
    longest = std::min(longest, largest_node_rotation / std::max(bend.norm(), 1.0));
  }
  return longest;
}

SpanSearchResult search_span(const RodSpan& span, double tolerance, const Deadline& deadline) {
  check_load(span);
  const RodSpan released = without_frames(span);
  SpanSearchResult search = search_without_frames(released, tolerance, deadline);
  if (!span.twisted()) return search;
  SpanEquilibrium twisted = twist_span(span, search.found.front(), tolerance, deadline);
  return {{std::move(twisted)}, search.complete && !deadline.passed()};
}

}  // namespace dlo::energy_model
