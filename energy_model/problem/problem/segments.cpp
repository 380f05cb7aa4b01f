#include "problem/segments.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

/// Slack of a segment, divided by its length, from which the segment is treated as hanging or
/// arched, without tension.
constexpr double largest_slack = 0.05;

/// Largest tension in the search [EI/l^2]; no rod is pulled harder without being stretched to its
/// length.
constexpr double largest_tension = 1e9;

double sine_of_half_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm() / 2;
}

/// Returns 1 - cos(phi / 2) of the angle phi between two unit vectors.
double one_minus_cosine_of_half(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double sine = sine_of_half_angle(a, b);
  return 1 - std::sqrt(std::max(0.0, 1 - sine * sine));
}

/// Returns the vector across the pull to the side of a tangent, of length sin(phi / 2).
Eigen::Vector3d transverse_part(const Eigen::Vector3d& tangent, const Eigen::Vector3d& pull) {
  const Eigen::Vector3d side = tangent - tangent.dot(pull) * pull;
  const double size = side.norm();
  if (!(size > 1e-12)) return Eigen::Vector3d::Zero();
  return sine_of_half_angle(tangent, pull) / size * side;
}

/// Returns the tension with which a segment reaches this distance; 0 if it has enough slack.
double tension_for(const Span& span, const Segment& segment, double distance) {
  const double length = segment.length();
  const double slack = length - distance;
  if (!(slack < largest_slack * length)) return 0;
  const auto across = [&](const Eigen::Vector3d& force) {
    return (force - force.dot(segment.pull) * segment.pull).squaredNorm();
  };
  const double layers = 2 * (one_minus_cosine_of_half(segment.begin_tangent, segment.pull) +
                             one_minus_cosine_of_half(segment.end_tangent, segment.pull));
  double sag = across(span.mean_weight()) * std::pow(length, 3) / 24;
  for (const Span::Load& load : span.loads) {
    const double x = load.at - segment.begin;
    if (x > 0 && x < length) sag += across(load.force) * x * (length - x) / (2 * length);
  }
  // The slack that layers and sag take decreases as the tension grows.
  double low = 0;
  double high = largest_tension;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (layers / std::sqrt(middle) + sag / (middle * middle) > slack ? low : high) = middle;
  }
  return low;
}

/// Updates direction of the pull and tension: the layers at the ends displace the rod sideways, and
/// the part between them points along the rest of the chord.
/// @return relative change of the tension
double update_pull_and_tension(const Span& span, Segment& segment) {
  const Eigen::Vector3d end_displacement = 2 / std::sqrt(segment.tension) *
                                           (transverse_part(segment.begin_tangent, segment.pull) +
                                            transverse_part(segment.end_tangent, segment.pull));
  const Eigen::Vector3d rest = segment.chord - end_displacement;
  segment.pull = rest.normalized();
  // The geometric mean damps the alternation between displacement and tension.
  const double before = segment.tension;
  segment.tension = std::sqrt(before * tension_for(span, segment, rest.dot(segment.pull)));
  return std::abs(segment.tension / before - 1);
}

/// Returns the tangent at a pin between two segments, at which both bend the rod equally: the
/// angles to the tangent are inversely proportional to the stiffness, which is the square root of
/// the tension, or 2 / length if that is larger.
Eigen::Vector3d tangent_between(const Segment& before, const Segment& after) {
  const auto stiffness = [](const Segment& segment) {
    return std::max(std::sqrt(segment.tension), 2 / segment.length());
  };
  const double share = stiffness(before) / (stiffness(before) + stiffness(after));
  const Eigen::Vector3d sum = share * before.pull + (1 - share) * after.pull;
  return sum.norm() > 1e-3 ? sum.normalized() : before.pull;
}

void set_tangents(const Span& span, std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Segment& own = segments[i];
    own.begin_tangent = own.begin_direction.value_or(
        i > 0 ? tangent_between(segments[i - 1], own) : span.start_direction.value_or(own.pull));
    own.end_tangent =
        own.end_direction.value_or(i + 1 < segments.size() ? tangent_between(own, segments[i + 1])
                                                           : span.end_direction.value_or(own.pull));
  }
}

}  // namespace

std::vector<Segment> segments_of(const Span& span) {
  if (span.holds.empty()) return {};
  std::vector<Span::Hold> points = {{span.anchor, Eigen::Vector3d::Zero()}};
  points.insert(points.end(), span.holds.begin(), span.holds.end());
  std::ranges::stable_sort(points, {}, &Span::Hold::at);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    Segment segment;
    segment.begin = points[i].at;
    segment.end = points[i + 1].at;
    segment.begin_direction = points[i].direction;
    segment.end_direction = points[i + 1].direction;
    segment.chord = points[i + 1].offset - points[i].offset;
    if (segment.chord.norm() > 0) segment.pull = segment.chord.normalized();
    segments.push_back(segment);
  }
  set_tangents(span, segments);
  for (Segment& segment : segments) {
    segment.tension = tension_for(span, segment, segment.chord.norm());
  }
  const std::vector<Segment> along_chords = segments;
  constexpr int most_rounds = 25;
  constexpr double tension_tolerance = 1e-2;
  double change = 1;
  for (int round = 0; round < most_rounds && change > tension_tolerance * tension_tolerance;
       ++round) {
    change = 0;
    set_tangents(span, segments);
    for (Segment& segment : segments) {
      if (segment.taut()) change = std::max(change, update_pull_and_tension(span, segment));
    }
  }
  return change < tension_tolerance ? segments : along_chords;
}

}  // namespace dlo::energy_model
