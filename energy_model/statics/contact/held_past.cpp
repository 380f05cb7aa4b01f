#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "contact/penalty_polygon.hpp"

namespace dlo::energy_model {
namespace {

/// Largest number of copies of the span. Each costs the relaxation of a coarse polygon; more of
/// them would dominate the cost of a search among many bodies.
constexpr std::size_t most_spans = 10;

/// Distance from a body's middle at which a shape passes it, divided by half of the body's size
/// there.
constexpr double passing_distance = 1.1;

/// Length of rod on the path past a body to a free end, divided by the path's length; > 1, because
/// without slack the initial guess would be a taut rod.
constexpr double path_slack = 1.01;

/// Length, divided by the span's length, below which a length counts as rounding.
constexpr double rounding_length = 1e-9;

/// An interval of a span between two neighbouring grips, or from the outermost grip to a free end.
struct PathInterval {
  double from_s = 0;                  ///< arc length of the grip at which a path past a body begins
  double length = 0;                  ///< length of this part of the rod
  double sense = 1;                   ///< 1 if arc lengths increase along the path, else -1
  Eigen::Vector3d from;               ///< position of the grip at from_s
  std::optional<Eigen::Vector3d> to;  ///< position of the grip at the other end; empty: free end
};

/// Points that the rod passes, in order from PathInterval::from.
using PathPoints = std::vector<Eigen::Vector3d>;

std::vector<PathInterval> path_intervals(const Span& span) {
  std::vector<Span::Hold> grips = {{span.anchor, Eigen::Vector3d::Zero()}};
  grips.insert(grips.end(), span.holds.begin(), span.holds.end());
  std::ranges::stable_sort(grips, {}, &Span::Hold::at);
  const double shortest = rounding_length * span.length;
  std::vector<PathInterval> reaches;
  for (std::size_t i = 0; i + 1 < grips.size(); ++i) {
    reaches.push_back(
        {grips[i].at, grips[i + 1].at - grips[i].at, 1, grips[i].offset, grips[i + 1].offset});
  }
  const Span::Hold& first = grips.front();
  const Span::Hold& last = grips.back();
  if (span.length - last.at > shortest) {
    reaches.push_back({last.at, span.length - last.at, 1, last.offset, std::nullopt});
  }
  if (first.at > shortest) {
    reaches.push_back({first.at, first.at, -1, first.offset, std::nullopt});
  }
  return reaches;
}

/// Returns the middle of a body; along an axis on which the body is endless, that of a nearby
/// point.
Eigen::Vector3d body_middle(const obstacle::Body& body, const Eigen::Vector3d& near) {
  Eigen::Vector3d local = body.axes().transpose() * (near - body.centre());
  const Eigen::Vector3d middle = (body.lower() + body.upper()) / 2;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (std::isfinite(body.lower()[axis])) local[axis] = middle[axis];
  }
  return body.centre() + body.axes() * local;
}

/// Returns half of the size of a body along a unit direction, ignoring an axis on which it is
/// endless.
double half_size(const obstacle::Body& body, const Eigen::Vector3d& direction) {
  double size = body.radius();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(body.lower()[axis])) continue;
    const double half = (body.upper()[axis] - body.lower()[axis]) / 2;
    size += half * std::abs(body.axes().col(axis).dot(direction));
  }
  return size;
}

/// Returns a unit direction normal to the path; the body may be passed on that side and on the
/// opposite one. It lies in the plane of a planar span. In space it is normal to the axis of an
/// endless body; for other bodies it lies in the plane of path and loads, or is arbitrary if the
/// loads have no component across the path. Returns std::nullopt if the body is endless along the
/// path, on an axis in the plane of a planar span, or on two axes.
std::optional<Eigen::Vector3d> side_of_path(const Span& span, const obstacle::Body& body,
                                            const Eigen::Vector3d& along) {
  std::vector<Eigen::Vector3d> infinite_axes;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(body.lower()[axis])) infinite_axes.emplace_back(body.axes().col(axis));
  }
  if (infinite_axes.size() > 1) return std::nullopt;
  Eigen::Vector3d side = Eigen::Vector3d::UnitZ().cross(along);
  if (!span.planar) {
    Eigen::Vector3d pull = span.weight_between(0, span.length);
    for (const Span::Load& load : span.loads) pull += load.force;
    side = pull - pull.dot(along) * along;
    if (!(side.norm() > rounding_length * (1 + pull.norm()))) side = along.unitOrthogonal();
  }
  if (!infinite_axes.empty()) side = infinite_axes.front().cross(along);
  if (span.planar) side.z() = 0;
  if (!(side.norm() > rounding_length)) return std::nullopt;
  return side.normalized();
}

/// Returns the points of a path that passes a body on one side. The first point is next to the
/// middle of the body. If the rod ends free, a second point follows at the far corner of the body,
/// from where the rod hangs clear of it. Returns std::nullopt if the path has no direction, or
/// side_of_path() no side.
/// @param from  last point of the path before the body
/// @param sense  1 to pass on the side of side_of_path(), -1 to pass on the opposite side
std::optional<PathPoints> path_past_body(const Span& span, const obstacle::Body& body,
                                         const PathInterval& reach, const Eigen::Vector3d& from,
                                         double sense) {
  const Eigen::Vector3d near = reach.to ? (reach.from + *reach.to) / 2 : reach.from;
  const Eigen::Vector3d middle = body_middle(body, near);
  Eigen::Vector3d along = reach.to ? *reach.to - reach.from : middle - from;
  if (!(along.norm() > rounding_length * span.length)) along = middle - from;
  if (!(along.norm() > rounding_length * span.length)) return std::nullopt;
  along.normalize();
  const std::optional<Eigen::Vector3d> side = side_of_path(span, body, along);
  if (!side) return std::nullopt;
  const Eigen::Vector3d side_point =
      middle + sense * passing_distance * half_size(body, *side) * *side;
  if (reach.to) return PathPoints{side_point};
  return PathPoints{side_point, side_point + half_size(body, along) * along};
}

/// Returns the span with pins at the points of a path; std::nullopt if the rod is too short for it.
std::optional<Span> pinned_on_path(const Span& span, const PathInterval& reach,
                                   const PathPoints& path) {
  std::vector<double> at;
  Eigen::Vector3d last = reach.from;
  double sum = 0;
  for (const Eigen::Vector3d& point : path) {
    sum += (point - last).norm();
    at.push_back(sum);
    last = point;
  }
  const double whole = reach.to ? sum + (*reach.to - last).norm() : sum * path_slack;
  if (!(whole < reach.length)) return std::nullopt;
  const double per_path = reach.to ? reach.length / whole : path_slack;
  Span pinned = span;
  for (std::size_t i = 0; i < path.size(); ++i) {
    pinned.holds.push_back(
        {.at = reach.from_s + reach.sense * per_path * at[i], .offset = path[i]});
  }
  std::ranges::stable_sort(pinned.holds, {}, &Span::Hold::at);
  return pinned;
}

/// Collects the copies with pins past single bodies, then past pairs, up to most_spans.
class PinnedSpans {
 public:
  explicit PinnedSpans(const Span& span) : span_(span) {
    for (const Span::SoftObstacle& obstacle : span.soft_obstacles) add_body(obstacle.body);
    for (const Span::Obstacle& obstacle : span.rigid_obstacles) add_body(obstacle.body);
    std::ranges::stable_sort(bodies_, {}, [](const obstacle::Body& body) {
      return body.clearance(Eigen::Vector3d::Zero());
    });
  }

  [[nodiscard]] std::vector<Span> all() && {
    const std::vector<PathInterval> reaches = path_intervals(span_);
    for (const obstacle::Body& body : bodies_) {
      for (const PathInterval& reach : reaches) add_spans_past({&body}, reach);
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = i + 1; j < bodies_.size(); ++j) {
        for (const PathInterval& reach : reaches) add_spans_past({&bodies_[i], &bodies_[j]}, reach);
      }
    }
    return std::move(spans_);
  }

 private:
  void add_body(const obstacle::Body& body) {
    if (!body.is_half_space()) bodies_.push_back(body);
  }

  /// Adds a copy of the span for each choice of the sides on which an interval passes the bodies.
  /// Paths with a point in a rigid obstacle are omitted, and so are copies beyond most_spans.
  /// @param row  one or two bodies, in any order
  void add_spans_past(std::vector<const obstacle::Body*> row, const PathInterval& reach) {
    const auto distance = [&](const obstacle::Body* body) {
      return (body_middle(*body, reach.from) - reach.from).norm();
    };
    std::ranges::sort(row, {}, distance);
    for (unsigned sides = 0; sides < 1U << row.size(); ++sides) {
      if (spans_.size() == most_spans) return;
      PathPoints path;
      for (std::size_t k = 0; k < row.size(); ++k) {
        const Eigen::Vector3d& from = path.empty() ? reach.from : path.back();
        const double sense = (sides >> k & 1U) == 0 ? 1 : -1;
        const std::optional<PathPoints> next = path_past_body(span_, *row[k], reach, from, sense);
        if (!next) return;
        path.insert(path.end(), next->begin(), next->end());
      }
      if (!is_clear(path)) continue;
      std::optional<Span> pinned = pinned_on_path(span_, reach, path);
      if (!pinned) continue;
      spans_.push_back(*std::move(pinned));
    }
  }

  /// Whether all points of a path are outside the rigid obstacles.
  [[nodiscard]] bool is_clear(const PathPoints& path) const {
    const auto is_inside = [&](const Span::Obstacle& obstacle) {
      return std::ranges::any_of(
          path, [&](const Eigen::Vector3d& point) { return obstacle.body.clearance(point) < 0; });
    };
    return std::ranges::none_of(span_.rigid_obstacles, is_inside);
  }

  const Span& span_;
  std::vector<obstacle::Body> bodies_;
  std::vector<Span> spans_;
};

}  // namespace

std::vector<Span> pinned_past_obstacles(const Span& span) { return PinnedSpans(span).all(); }

}  // namespace dlo::energy_model
