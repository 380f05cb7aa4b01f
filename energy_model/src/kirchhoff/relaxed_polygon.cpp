#include "kirchhoff/relaxed_polygon.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

constexpr int most_rounds = 200;  // of the augmented Lagrangian
constexpr int sweeps = 20;        // over the rod in a round
constexpr double at_rest = 1e-4;  // change of a tangent in a round, and gap at a grip
constexpr double same_shape = 0.02;

/// The intervals between two neighbouring grips.
struct Closure {
  Eigen::Index first;
  Eigen::VectorXd h;                                // widths
  Eigen::Vector3d chord;                            // from grip to grip
  double slack;                                     // rod to spare
  double penalty;                                   // force per gap
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // multiplier

  [[nodiscard]] Eigen::Index end() const { return first + h.size(); }
  [[nodiscard]] Eigen::Vector3d gap(const Eigen::Matrix3Xd& tangents) const {
    return tangents.middleCols(first, h.size()) * h - chord;
  }
};

std::vector<Closure> closures_of(const RodSpan& span, const RodMesh& mesh) {
  std::vector<Closure> closures;
  const RodSpan::Hold* previous = nullptr;
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < mesh.hold.size(); ++i) {
    const RodSpan::Hold* hold = mesh.hold[i];
    if (hold == nullptr) continue;
    const auto end = static_cast<Eigen::Index>(i);
    if (previous != nullptr) {
      const Eigen::Index size = end - first;
      const Eigen::VectorXd h = mesh.s.segment(first + 1, size) - mesh.s.segment(first, size);
      const Eigen::Vector3d chord = hold->position - previous->position;
      const double length = h.sum();
      const double penalty =
          (100 * softest(span) / (length * length) + 4 * total_load(span)) / length;
      closures.push_back({first, h, chord, length - chord.norm(), penalty});
    }
    previous = hold;
    first = end;
  }
  return closures;
}

/// Of the rod in an interval: int ds / b.
double compliance_in(const RodMesh& mesh, Eigen::Index i) {
  return mesh.width(i) / mesh.section_of(i).bending;
}

/// Of the rod between the middles of an interval and the next.
double compliance_between(const RodMesh& mesh, Eigen::Index i) {
  return (compliance_in(mesh, i) + compliance_in(mesh, i + 1)) / 2;
}

const RodSpan::Clamp* start_clamp(const RodSpan& span) { return span.clamp_at(0); }
const RodSpan::Clamp* end_clamp(const RodSpan& span) { return span.clamp_at(span.length); }

/// Sum of the tangents that an interval's bends to, over the compliances: it pulls the interval.
Eigen::Vector3d bending_pull(const RodSpan& span, const RodMesh& mesh, const Eigen::Matrix3Xd& t,
                             Eigen::Index i) {
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  const double c = compliance_in(mesh, i);
  if (i > 0) pull += t.col(i - 1) / compliance_between(mesh, i - 1);
  if (i + 1 < t.cols()) pull += t.col(i + 1) / compliance_between(mesh, i);
  const auto clamp = [&](const RodSpan::Clamp* end) {
    if (end != nullptr) pull += 2 / c * end->direction;
  };
  if (i == 0) clamp(start_clamp(span));
  if (i + 1 == t.cols()) clamp(end_clamp(span));
  return pull;
}

/// The multiplier with which a shape is as near to equilibrium as it can be, by least squares. A
/// flat arch would otherwise be straight before its thrust has grown.
Eigen::Vector3d fitting_force(const RodSpan& span, const RodMesh& mesh, const Eigen::Matrix3Xd& t,
                              const Eigen::Matrix3Xd& carried, const Closure& closure) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index i = closure.first; i < closure.end(); ++i) {
    const double h = closure.h[i - closure.first];
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t.col(i) * t.col(i).transpose();
    matrix += h * h * across;
    right -= h * across * (bending_pull(span, mesh, t, i) + h * carried.col(i));
  }
  return matrix.completeOrthogonalDecomposition().solve(right);
}

double energy_of(const RodSpan& span, const RodMesh& mesh, const RelaxedPolygon& polygon,
                 const Eigen::Matrix3Xd& carried) {
  const Eigen::Matrix3Xd& t = polygon.tangents;
  const Eigen::Index last = t.cols() - 1;
  double energy = 0;
  for (Eigen::Index i = 0; i <= last; ++i) {
    const double h = mesh.s[i + 1] - mesh.s[i];
    energy -= h * carried.col(i).dot(t.col(i));
    if (i < last) energy += (1 - t.col(i).dot(t.col(i + 1))) / compliance_between(mesh, i);
  }
  const auto to_clamp = [&](Eigen::Index i, const RodSpan::Clamp* clamp) {
    if (clamp == nullptr) return 0.0;
    return 2 * (1 - t.col(i).dot(clamp->direction)) / compliance_in(mesh, i);
  };
  return energy + to_clamp(0, start_clamp(span)) + to_clamp(last, end_clamp(span));
}

/// A line that the span runs along, more or less, and the share of the span's length that it may
/// cover.
struct Line {
  Eigen::Vector3d direction;
  double share;
};

Line line_of(const RodSpan& span) {
  const RodSpan::Hold& first = span.holds.front();
  const RodSpan::Hold& last = span.holds.back();
  const Eigen::Vector3d chord = last.position - first.position;
  if (last.at > first.at && chord.norm() > 1e-6) {
    return {chord.normalized(), chord.norm() / (last.at - first.at)};
  }
  const double share = last.at > first.at ? 0 : 0.7;
  if (!span.clamps.empty()) return {span.clamps.front().direction, share};
  return {span.plane ? span.plane->x : Eigen::Vector3d::UnitX(), share};
}

std::vector<Eigen::Vector3d> normals_of(const RodSpan& span, const Eigen::Vector3d& line,
                                        bool planar) {
  if (planar) {
    const Eigen::Vector3d normal = span.plane->x.cross(span.plane->y).cross(line);
    return {normal, -normal};
  }
  const Eigen::Vector3d first =
      span.plane ? span.plane->x.cross(span.plane->y).eval() : line.unitOrthogonal().eval();
  const Eigen::Vector3d second = line.cross(first);
  std::vector<Eigen::Vector3d> normals;
  constexpr int count = 6;
  for (int i = 0; i < count; ++i) {
    // Not through the plane itself, where the planar search has been.
    const double angle = 2 * pi * (i + 0.1) / count;
    normals.emplace_back(std::cos(angle) * first + std::sin(angle) * second);
  }
  return normals;
}

std::vector<Eigen::Matrix3Xd> starts_of(const RodSpan& span, const RodMesh& mesh, bool planar) {
  const Line line = line_of(span);
  const double amplitude = 2 * std::sqrt(std::max(0.0, 1 - line.share));
  const std::vector<std::function<double(double)>> angles = {
      [&](double x) { return amplitude * std::cos(pi * x); },
      [&](double x) { return amplitude * std::sin(2 * pi * x); },
      [&](double x) { return amplitude * std::cos(2 * pi * x); },
      [&](double x) { return 2 * pi * x; }};
  const Eigen::Index count = mesh.intervals();
  const Eigen::Matrix3Xd straight = line.direction.replicate(1, count);
  std::vector<Eigen::Matrix3Xd> starts = {straight};
  const Eigen::Matrix3Xd carried = carried_force(span, mesh).on_interval;
  Eigen::Matrix3Xd hanging = straight;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (carried.col(i).norm() > 0) hanging.col(i) = carried.col(i).normalized();
  }
  starts.push_back(hanging);
  for (const auto& angle : angles) {
    for (const Eigen::Vector3d& normal : normals_of(span, line.direction, planar)) {
      Eigen::Matrix3Xd start(3, count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const double a = angle((mesh.s[i] + mesh.s[i + 1]) / 2 / span.length);
        start.col(i) = std::cos(a) * line.direction + std::sin(a) * normal;
      }
      starts.push_back(start);
    }
  }
  return starts;
}

}  // namespace

RelaxedPolygon relax_polygon(const RodSpan& span, const RodMesh& mesh, Eigen::Matrix3Xd tangents,
                             bool planar, const Deadline& deadline) {
  const Eigen::Matrix3Xd carried = carried_force(span, mesh).on_interval;
  std::vector<Closure> closures = closures_of(span, mesh);
  const Eigen::Index count = mesh.intervals();
  const Eigen::Vector3d normal =
      planar ? span.plane->x.cross(span.plane->y).eval() : Eigen::Vector3d::Zero();
  RelaxedPolygon polygon;
  Eigen::Matrix3Xd& t = polygon.tangents;
  t = std::move(tangents);
  for (Closure& closure : closures) {
    closure.force = fitting_force(span, mesh, t, carried, closure);
  }
  polygon.force = carried;
  for (int round = 0; round < most_rounds && !deadline.passed(); ++round) {
    const Eigen::Matrix3Xd before = t;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const auto lay = [&](Eigen::Index i, Eigen::Vector3d pull) {
        const double h = mesh.s[i + 1] - mesh.s[i];
        pull += bending_pull(span, mesh, t, i);
        pull += h * carried.col(i);
        pull -= pull.dot(normal) * normal;
        if (pull.norm() > 0) t.col(i) = pull.normalized();
      };
      Eigen::Index i = 0;
      for (const Closure& closure : closures) {
        for (; i < closure.first; ++i) lay(i, Eigen::Vector3d::Zero());
        Eigen::Vector3d gap = closure.gap(t);
        for (; i < closure.end(); ++i) {
          const double own = closure.h[i - closure.first];
          gap -= own * t.col(i);
          lay(i, own * (closure.force - closure.penalty * gap));
          gap += own * t.col(i);
        }
      }
      for (; i < count; ++i) lay(i, Eigen::Vector3d::Zero());
    }
    bool closed = true;
    for (Closure& closure : closures) {
      const Eigen::Vector3d gap = closure.gap(t);
      closure.force -= closure.penalty * gap;
      closed = closed && gap.norm() < at_rest * std::min(1.0, 100 * closure.slack);
      polygon.force.middleCols(closure.first, closure.h.size()) =
          carried.middleCols(closure.first, closure.h.size()).colwise() + closure.force;
    }
    if (closed && (t - before).colwise().norm().maxCoeff() < at_rest) break;
  }
  polygon.energy = energy_of(span, mesh, polygon, carried);
  return polygon;
}

PolygonMinima polygon_minima(const RodSpan& span, const RodMesh& mesh, bool planar,
                             const Deadline& deadline) {
  PolygonMinima minima;
  std::vector<RelaxedPolygon>& found = minima.found;
  for (const Eigen::Matrix3Xd& start : starts_of(span, mesh, planar)) {
    RelaxedPolygon polygon = relax_polygon(span, mesh, start, planar, deadline);
    if (deadline.passed()) {
      minima.complete = false;
      if (!found.empty()) break;
    }
    const bool known = std::any_of(found.begin(), found.end(), [&](const RelaxedPolygon& other) {
      return (other.tangents - polygon.tangents).colwise().norm().maxCoeff() < same_shape;
    });
    if (!known) found.push_back(std::move(polygon));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.energy < b.energy; });
  return minima;
}

std::vector<RodState> states_of(const RodSpan& span, const RodMesh& mesh,
                                const RelaxedPolygon& polygon) {
  const Eigen::Index last = mesh.intervals();
  const Eigen::Matrix3Xd& t = polygon.tangents;
  const Eigen::Matrix3Xd after_node = carried_force(span, mesh).after_node;
  const Eigen::Matrix3Xd carried = carried_force(span, mesh).on_interval;
  std::vector<RodState> states(static_cast<std::size_t>(last + 1));
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i <= last; ++i) {
    RodState& state = states[static_cast<std::size_t>(i)];
    const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
    const Eigen::Index after = std::min(i, last - 1);
    Eigen::Vector3d tangent = (t.col(before) + t.col(after)).normalized();
    if (before < after) {
      state.m = tangent.cross(t.col(after) - t.col(before)) / compliance_between(mesh, before);
    }
    if (const RodSpan::Clamp* clamp = i == 0 ? start_clamp(span) : nullptr) {
      tangent = clamp->direction;
      state.m = 2 / compliance_in(mesh, 0) * tangent.cross(t.col(0));
    }
    if (const RodSpan::Clamp* clamp = i == last ? end_clamp(span) : nullptr) {
      tangent = clamp->direction;
    }
    state.R = frame_of(tangent.unitOrthogonal(), tangent);
    state.r = r;
    if (mesh.hold[static_cast<std::size_t>(i)] == &span.holds.front()) {
      shift = span.holds.front().position - r;
    }
    if (i == last) break;
    // What the grips add is constant between them.
    state.n = after_node.col(i) + polygon.force.col(i) - carried.col(i);
    r += mesh.width(i) * t.col(i);
  }
  for (RodState& state : states) state.r += shift;
  return states;
}

}  // namespace dlo::energy_model
