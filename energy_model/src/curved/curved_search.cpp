#include "curved/curved_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/found_equilibria.hpp"
#include "base/require.hpp"
#include "base/sized_samples.hpp"
#include "curved/curved_polygon.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"
#include "shooting/span_equilibrium.hpp"
#include "shooting/span_shooting.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;

constexpr double most_force = 1e6;               // of weight and loads, in EI/l^2
constexpr double same_frames = 1e-6;             // of two equilibria
constexpr double same_polygon = 0.02;            // of two polygons
constexpr std::size_t most_shot_polygons = 8;    // if one leads to a minimum
constexpr double share_of_polygons = 0.5;        // of the time that is left
constexpr int most_left = 8;                     // saddles
constexpr double away = 0.3;                     // largest spin when a saddle is left
constexpr double most_bend = 0.3;                // of a polygon at a node, by nature
constexpr double first_roll_step = 0.5;          // [rad]
constexpr double longest_roll_step = 1.5;        // [rad]
constexpr double shortest_roll_step = 1.0 / 64;  // [rad]
constexpr double most_frame_change = 0.7;        // of a tangent in a step of the roll
constexpr double most_polygon_change = 1.5;      // of a tangent from a polygon to its equilibrium

/// Largest difference of the components of two shapes' frames.
double frame_distance(const CurvedRod& rod, const SpanEquilibrium& a, const SpanEquilibrium& b,
                      bool tangents) {
  std::vector<double> probes;
  for (int i = 0; i <= 24; ++i) probes.push_back(i / 24.0);
  constexpr double coarse = 1e-9;
  const std::vector<RodState> first = states_at(a, rod.span, probes, coarse);
  const std::vector<RodState> second = states_at(b, rod.span, probes, coarse);
  double distance = 0;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const Eigen::Matrix3d change = first[i].R - second[i].R;
    distance = std::max(distance, tangents ? change.col(2).norm() : change.cwiseAbs().maxCoeff());
  }
  return distance;
}

double polygon_distance(const CurvedPolygon& a, const CurvedPolygon& b) {
  double distance = 0;
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    distance = std::max(distance, a.frames[i].angularDistance(b.frames[i]));
  }
  return distance;
}

/// Intervals that resolve what a force over b and the natural strains bend.
double resolving_interval(const CurvedRod& rod, double force) {
  double longest = longest_interval(rod.span, force);
  constexpr int probes = 32;
  for (int i = 0; i <= probes; ++i) {
    const double bend = rod.span.natural(static_cast<double>(i) / probes).norm();
    longest = std::min(longest, most_bend / std::max(bend, 1.0));
  }
  return longest;
}

/// Frames of the intervals of a mesh beside a shape: turned by the mode of its smallest eigenvalue.
std::vector<Quaterniond> beside(const CurvedRod& rod, const RodMesh& mesh,
                                const SpanEquilibrium& shape, double amplitude) {
  const Eigen::VectorXd middles =
      (mesh.s.head(mesh.intervals()) + mesh.s.tail(mesh.intervals())) / 2;
  constexpr double coarse = 1e-9;
  const std::vector<RodState> states =
      states_at(shape, rod.span, {middles.begin(), middles.end()}, coarse);
  Eigen::Matrix3Xd spins = Eigen::Matrix3Xd::Zero(3, middles.size());
  if (shape.stability.s.size() > 0) spins = amplitude * shape.stability.spin_at(middles);
  std::vector<Quaterniond> frames;
  for (Eigen::Index i = 0; i < middles.size(); ++i) {
    frames.emplace_back(rotation_by(spins.col(i)) * states[static_cast<std::size_t>(i)].R);
  }
  return frames;
}

class CurvedSearch {
 public:
  CurvedSearch(const CurvedRod& rod, double tolerance, const Deadline& deadline)
      : rod_(rod),
        mesh_(
            make_mesh(rod.span, resolving_interval(rod, total_load(rod.span) / softest(rod.span)))),
        deadline_(deadline) {
    options_.tolerance = tolerance;
    options_.deadline = deadline;
  }

  SpanSearchResult run() {
    const ClampFrames frames = released_frames(rod_.span);
    std::vector<CurvedPolygon> polygons;
    const Deadline relaxing(share_of_polygons * deadline_.remaining());
    if (rod_.planar()) add_polygons(frames, true, relaxing, polygons);
    add_polygons(frames, false, relaxing, polygons);
    bool complete = !relaxing.passed();
    std::stable_sort(polygons.begin(), polygons.end(),
                     [](const auto& a, const auto& b) { return a.energy < b.energy; });
    for (std::size_t i = 0; i < polygons.size() && !deadline_.passed(); ++i) {
      if (i >= (std::isfinite(lowest_stable_energy(found_)) ? 1 : 2) * most_shot_polygons) break;
      add(shoot_from(polygons[i], frames));
    }
    leave_saddles(frames);
    complete = complete && !deadline_.passed();
    if (found_.empty()) {
      if (!complete) failed_.message = to_string(SolveStatus::time_limit);
      found_.push_back(std::move(failed_));
    }
    sort_by_stability(found_);
    const bool turned = std::any_of(rod_.span.clamps.begin(), rod_.span.clamps.end(),
                                    [](const auto& clamp) { return clamp.frame.has_value(); });
    if (turned && found_.front().converged) found_ = {turn_frames(found_.front())};
    found_.front().shots = shots_;
    return {std::move(found_), complete && !deadline_.passed()};
  }

 private:
  void add_polygons(const ClampFrames& frames, bool planar, const Deadline& deadline,
                    std::vector<CurvedPolygon>& polygons) {
    for (const auto& start : curved_starts(rod_, mesh_, planar)) {
      if (deadline.passed()) return;
      CurvedPolygon polygon = relax_curved(rod_, mesh_, frames, start, deadline);
      const bool known = std::any_of(polygons.begin(), polygons.end(), [&](const auto& other) {
        return polygon_distance(other, polygon) < same_polygon;
      });
      if (!known) polygons.push_back(std::move(polygon));
    }
  }

  SpanEquilibrium shoot_from(const CurvedPolygon& polygon, const ClampFrames& frames) {
    SpanEquilibrium shape = shoot_span(
        rod_.span, mesh_, curved_states_of(rod_, mesh_, frames, polygon), frames, options_);
    shots_ += shape.shots;
    return shape;
  }

  void add(SpanEquilibrium shape) {
    if (!shape.converged) {
      failed_ = std::move(shape);
      return;
    }
    const bool known = std::any_of(found_.begin(), found_.end(), [&](const auto& other) {
      return frame_distance(rod_, other, shape, false) < same_frames;
    });
    if (!known) found_.push_back(std::move(shape));
  }

  /// An unstable equilibrium below all stable ones shows that a minimum has been missed.
  void leave_saddles(const ClampFrames& frames) {
    std::vector<double> left;  // energies
    for (int i = 0; i < most_left && !deadline_.passed(); ++i) {
      const SpanEquilibrium* lowest = missed_minimum(found_, left);
      if (lowest == nullptr) return;
      left.push_back(lowest->energy.total());
      const SpanEquilibrium saddle = *lowest;
      for (const double side : {away, -away}) add(relaxed_from(saddle, side, frames));
    }
  }

  SpanEquilibrium relaxed_from(const SpanEquilibrium& shape, double amplitude,
                               const ClampFrames& frames) {
    const std::vector<Quaterniond> start = beside(rod_, mesh_, shape, amplitude);
    return shoot_from(relax_curved(rod_, mesh_, frames, start, deadline_), frames);
  }

  /// By which the frames are turned from where the rod without them has them.
  [[nodiscard]] std::vector<double> targets_of(const SpanEquilibrium& released) const {
    std::vector<double> targets;
    const auto sample = [&](std::span<const double> at) {
      Samples samples = sized_samples(at, 1);
      const auto states =
          states_at(released, rod_.span, {at.begin(), at.end()}, options_.tolerance);
      for (std::size_t i = 0; i < states.size(); ++i) {
        samples.points.col(static_cast<Eigen::Index>(i)) = states[i].r;
        samples.tangents.col(static_cast<Eigen::Index>(i)) = states[i].R.col(2);
      }
      return samples;
    };
    for (const RodSpan::Clamp& clamp : rod_.span.clamps) {
      targets.push_back(0);
      if (!clamp.frame) continue;
      const auto& [d1, turns] = *clamp.frame;
      // From the frame that the rod without rolls would have there.
      const Eigen::Matrix3d own = rolled(frame_at(released, clamp.at), -rod_.first_roll);
      const double ahead = std::atan2(own.col(1).dot(d1), own.col(0).dot(d1));
      std::optional<double> before;
      if (turns.turns) before = writhe(sample, rod_.span.clamps.front().at, clamp.at);
      targets.back() = turned_angle(turns, ahead, before);
    }
    return targets;
  }

  [[nodiscard]] Eigen::Matrix3d frame_at(const SpanEquilibrium& shape, double s) const {
    return states_at(shape, rod_.span, {s}, options_.tolerance).front().R;
  }

  /// The frames after a part of the way to the targets.
  [[nodiscard]] ClampFrames frames_after(double part, const ClampFrames& released,
                                         const std::vector<double>& targets) const {
    ClampFrames frames = released_frames(rod_.span);
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (rod_.span.clamps[k].frame) frames[k] = rolled(*released[k], part * targets[k]);
    }
    return frames;
  }

  SpanEquilibrium turn_frames(const SpanEquilibrium& without) {
    const std::vector<double> targets = targets_of(without);
    ClampFrames released(rod_.span.clamps.size());
    double widest = 0;
    for (std::size_t k = 0; k < released.size(); ++k) {
      const RodSpan::Clamp& clamp = rod_.span.clamps[k];
      released[k] = frame_of(frame_at(without, clamp.at).col(0), clamp.direction);
      widest = std::max(widest, std::abs(targets[k]));
    }
    // The frames are held: what turns them costs twist.
    SpanEquilibrium now = shoot_span(rod_.span, mesh_at(rod_.span, without.s), without.nodes,
                                     frames_after(0, released, targets), options_);
    double reached = 0;
    double step = first_roll_step;
    while (now.converged && reached < widest) {
      const double next = std::min(widest, reached + step);
      SpanEquilibrium found = advance(now, frames_after(next / widest, released, targets),
                                      step / 2 < shortest_roll_step);
      if (found.converged) {
        now = std::move(found);
        reached = next;
        step = std::min(longest_roll_step, 1.5 * step);
        continue;
      }
      step /= 2;
      if (step >= shortest_roll_step && !deadline_.passed()) continue;
      now.converged = false;
      now.message = "frames rotated by " + std::to_string(reached) + " of " +
                    std::to_string(widest) + " rad: " +
                    (deadline_.passed() ? to_string(SolveStatus::time_limit)
                                        : "no stable shape was found beyond it");
    }
    return now;
  }

  /// One step of the frames.
  /// @param may_jump  a shape further away will do
  SpanEquilibrium advance(const SpanEquilibrium& from, const ClampFrames& frames, bool may_jump) {
    SpanEquilibrium found =
        shoot_span(rod_.span, mesh_at(rod_.span, from.s), from.nodes, frames, options_);
    shots_ += found.shots;
    if (found.stable() && frame_distance(rod_, found, from, true) < most_frame_change) return found;
    const bool near =
        found.converged && frame_distance(rod_, found, from, true) < most_frame_change;
    if (!near && !may_jump) return {};
    for (const double side : {away, -away}) {
      SpanEquilibrium left = relaxed_from(near ? found : from, near ? side : 0, frames);
      if (left.stable() &&
          (may_jump || near || frame_distance(rod_, left, from, true) < most_polygon_change)) {
        return left;
      }
    }
    return {};
  }

  const CurvedRod& rod_;
  RodMesh mesh_;
  Deadline deadline_;
  ShootingOptions options_;
  std::vector<SpanEquilibrium> found_;
  SpanEquilibrium failed_;
  int shots_ = 0;
};

void check_force(const CurvedRod& rod) {
  const double force = total_load(rod.span) / softest(rod.span);
  require(force <= most_force, "solve_exact", "sum of weight and loads over EI/l^2", force,
          "<= 1e6");
}

/// Cross-sections at the nodes of a mesh of a shape: moments from what its grips exert, frames from
/// its d1 or, as good as a start needs, from the first clamp's on.
std::vector<RodState> states_of_shape(const CurvedRod& rod, const Problem& problem,
                                      const Equilibrium& shape, const RodMesh& mesh,
                                      double tolerance) {
  constexpr Eigen::Index parts = 8;  // of an interval
  const Eigen::Index count = parts * mesh.intervals();
  std::vector<double> s;
  s.reserve(static_cast<std::size_t>(count + 1));
  for (Eigen::Index k = 0; k <= count; ++k) {
    const Eigen::Index i = std::min(k / parts, mesh.intervals() - 1);
    s.push_back(mesh.s[i] + mesh.width(i) * static_cast<double>(k - parts * i) / parts);
  }
  std::vector<double> arc_lengths;
  arc_lengths.reserve(s.size());
  for (const double at : s) arc_lengths.push_back(std::min(at * rod.length, rod.length));
  const Samples samples = shape.sample(arc_lengths);
  const Eigen::Matrix3Xd r =
      rod.axes.transpose() * (samples.points.colwise() - rod.origin) / rod.length;
  const Eigen::Matrix3Xd t = rod.axes.transpose() * samples.tangents;
  const auto force_at = [&](double at) {
    return Eigen::Vector3d(rod.axes.transpose() * implied_force(problem, shape, at));
  };
  std::vector<RodState> states(static_cast<std::size_t>(count + 1));
  const double torque_unit = bending_unit(problem) / problem.length;
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  for (Eigen::Index k = count; k >= 0; --k) {
    RodState& state = states[static_cast<std::size_t>(k)];
    const double at = s[static_cast<std::size_t>(k)];
    state.r = r.col(k);
    state.m = m;
    if (k < count) state.n = force_at(at);
    for (const RodSpan::Hold& hold : rod.span.holds) {
      if (hold.at == at) m += rod.axes.transpose() * shape.grips[hold.grip].torque / torque_unit;
    }
    if (k == 0) break;
    const double before = s[static_cast<std::size_t>(k - 1)];
    m -= force_at((before + at) / 2).cross(Eigen::Vector3d(r.col(k) - r.col(k - 1)));
  }
  for (Eigen::Index k = 0; k <= count; ++k) {
    const Eigen::Vector3d tangent = t.col(k).normalized();
    const Eigen::Vector3d d1 = samples.d1.cols() > 0
                                   ? Eigen::Vector3d(rod.axes.transpose() * samples.d1.col(k))
                                   : tangent.unitOrthogonal();
    states[static_cast<std::size_t>(k)].R = frame_of(d1, tangent);
  }
  std::vector<RodState> nodes;
  for (Eigen::Index k = 0; k <= count; k += parts) {
    nodes.push_back(states[static_cast<std::size_t>(k)]);
  }
  if (samples.d1.cols() == 0) carry_frames(rod.span, mesh, tolerance, nodes);
  return nodes;
}

}  // namespace

SpanSearchResult search_curved(const CurvedRod& rod, double tolerance, const Deadline& deadline) {
  check_force(rod);
  return CurvedSearch(rod, tolerance, deadline).run();
}

SpanEquilibrium refine_curved(const CurvedRod& rod, const Problem& problem,
                              const Equilibrium& shape, double tolerance,
                              const Deadline& deadline) {
  check_force(rod);
  require(!rod.span.clamps.empty(), "solve_exact", "number of clamps of a curved rod with a start",
          0, ">= 1: the frames of the start are not known");
  const double b = softest(rod.span);
  double force = total_load(rod.span) / b;
  for (const Reaction& grip : shape.grips) {
    const double unit = bending_unit(problem) / (problem.length * problem.length);
    force = std::max(force, grip.force.norm() / unit / b);
  }
  const RodMesh mesh = make_mesh(rod.span, resolving_interval(rod, std::min(force, most_force)));
  std::vector<RodState> start = states_of_shape(rod, problem, shape, mesh, tolerance);
  ClampFrames frames = released_frames(rod.span);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const RodSpan::Clamp& clamp = rod.span.clamps[k];
    if (!clamp.frame) continue;
    frames[k] = rolled(frame_of(clamp.frame->d1, clamp.direction),
                       clamp.frame->turns.roll + rod.first_roll);
  }
  ShootingOptions options;
  options.tolerance = tolerance;
  options.deadline = deadline;
  return shoot_span(rod.span, mesh, std::move(start), frames, options);
}

}  // namespace dlo::energy_model
