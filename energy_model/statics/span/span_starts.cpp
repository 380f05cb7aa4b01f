#include "span/span_starts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "dlo/energy_model/turns.hpp"
#include "problem/segments.hpp"
#include "strain/span_energy.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

Eigen::Vector3d total_force(const Span& span, double beyond) {
  Eigen::Vector3d n = span.weight_between(beyond, span.length);
  for (const Span::Load& load : span.loads) {
    if (load.at > beyond) n += load.force;
  }
  return n;
}

/// Returns a unit vector normal to `direction`, in the plane of a planar span.
Eigen::Vector3d across(const Span& span, const Eigen::Vector3d& direction) {
  if (span.planar) return Eigen::Vector3d(-direction.y(), direction.x(), 0).normalized();
  return direction.unitOrthogonal();
}

/// Returns the tangent, at a distance from a clamp or grip with tangent `from`, of a soft rod that
/// bends towards the force. @param turns  0: by the shorter way; 1: by the longer way
Eigen::Vector3d pendulum(const Span& span, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& force, double distance, int turns) {
  const double size = force.norm();
  if (!(size > 0)) return from;
  const Eigen::Vector3d axis = force / size;
  Eigen::Vector3d side = from - from.dot(axis) * axis;
  // If the tangent is opposite to the force, both senses of rotation have the same angle. In a
  // plane the rod then bends to the left of the tangent.
  if (side.norm() < 1e-9) side = -across(span, axis);
  side.normalize();
  const double turn = std::atan2(from.dot(side), from.dot(axis)) - 2 * pi * turns;
  const double psi = 4 * std::atan(std::tan(turn / 4) * std::exp(-std::sqrt(size) * distance));
  return std::cos(psi) * axis + std::sin(psi) * side;
}

/// Returns A with J_0(A) = ratio, the quotient of chord and arc length: the amplitude of a
/// sinusoidal tangent angle that has this slack.
double slack_amplitude(double ratio) {
  constexpr double first_zero = 2.404825557695773;
  constexpr int most_steps = 10;
  // For small slack J_0 = 1 - A^2 / 4. Newton's method overshoots once and then converges from
  // above.
  double amplitude = 2 * std::sqrt(std::max(0.0, 1 - ratio));
  for (int i = 0; i < most_steps && amplitude > 0; ++i) {
    const double by = (std::cyl_bessel_j(0, amplitude) - ratio) / std::cyl_bessel_j(1, amplitude);
    amplitude = std::min(amplitude + by, first_zero);
    if (std::abs(by) < 1e-12) break;
  }
  return amplitude;
}

/// Number of coefficients with which the stress-free shape is sampled.
constexpr int natural_shape_terms = 32;

struct Pattern {
  bool s_shape = false;
  double sign = 1;
  int loops = 0;
  bool out_of_plane = false;
};

/// Tangents between grips: chords with arches on them, bent at the clamps to their directions.
class GrippedField {
 public:
  GrippedField(const Span& span, const Pattern& pattern)
      : span_(span), pattern_(pattern), segments_(segments_of(span)) {
    for (const Segment& segment : segments_) {
      const double ratio = segment.chord.norm() / segment.length();
      Eigen::Vector3d along = Eigen::Vector3d::UnitX();
      if (ratio > 1e-6) {
        along = segment.chord.normalized();
      } else if (span.start_direction) {
        along = *span.start_direction;
      }
      const Eigen::Vector3d weight = span.mean_weight();
      Eigen::Vector3d down = weight - weight.dot(along) * along;
      if (down.norm() < 1e-9 * (1 + weight.norm())) down = across(span, along);
      down.normalize();
      if (pattern.out_of_plane) down = along.cross(down);
      chords_.push_back({along, down, slack_amplitude(std::min(1.0, ratio))});
    }
  }

  [[nodiscard]] Eigen::Vector3d operator()(double s) const {
    if (chords_.empty()) return free_end(s, Eigen::Vector3d::UnitX());
    if (s < segments_.front().begin) return free_end(s, bent(0, 0));
    if (s > segments_.back().end) return free_end(s, bent(chords_.size() - 1, 1));
    std::size_t i = 0;
    while (i + 1 < chords_.size() && s > segments_[i].end) ++i;
    return bent(i, (s - segments_[i].begin) / segments_[i].length());
  }

 private:
  struct Chord {
    Eigen::Vector3d along, down;
    double amplitude;
  };

  [[nodiscard]] Eigen::Vector3d arch(std::size_t i, double u) const {
    const Chord& chord = chords_[i];
    // An arch leaves the chord's line towards `down` and returns; an S-shape crosses it.
    const double wave = pattern_.s_shape ? std::cos(2 * pi * u) : std::sin(2 * pi * u);
    double angle = pattern_.sign * chord.amplitude * wave;
    angle += 2 * pi * pattern_.loops * u;
    return std::cos(angle) * chord.along + std::sin(angle) * chord.down;
  }

  /// Returns the force normal to the pull, on a taut segment beyond s, which deflects it from the
  /// chord; its mean is subtracted, so that the segment ends at the chord's end. At a load it
  /// changes over the length of a layer.
  [[nodiscard]] Eigen::Vector3d transverse_force(const Segment& segment, double s) const {
    Eigen::Vector3d force = span_.weight_between(s, (segment.begin + segment.end) / 2);
    const double layer = 1 / std::sqrt(segment.tension);
    for (const Span::Load& load : span_.loads) {
      if (!(load.at > segment.begin && load.at < segment.end)) continue;
      const double scaled_distance = (load.at - s) / layer;
      const double beyond =
          0.5 + std::copysign(0.5 * -std::expm1(-std::abs(scaled_distance)), scaled_distance);
      force += (beyond - (load.at - segment.begin) / segment.length()) * load.force;
    }
    return force - force.dot(segment.pull) * segment.pull;
  }

  /// Returns the tangent of a rod under this tension: along the force, except in the layers at its
  /// ends.
  [[nodiscard]] Eigen::Vector3d stretched(std::size_t i, double u) const {
    const Segment& segment = segments_[i];
    const auto pull_at = [&](double s) {
      return Eigen::Vector3d(segment.tension * segment.pull + transverse_force(segment, s));
    };
    const double from_begin = u * segment.length();
    const Eigen::Vector3d begin_pull = pull_at(segment.begin);
    const Eigen::Vector3d end_pull = pull_at(segment.end);
    const Eigen::Vector3d at_begin =
        pendulum(span_, segment.begin_tangent, begin_pull, from_begin, 0);
    const Eigen::Vector3d at_end =
        pendulum(span_, segment.end_tangent, end_pull, segment.length() - from_begin, 0);
    return (pull_at(segment.begin + from_begin).normalized() + at_begin - begin_pull.normalized() +
            at_end - end_pull.normalized())
        .normalized();
  }

  [[nodiscard]] Eigen::Vector3d bent(std::size_t i, double u) const {
    if (segments_[i].taut() && pattern_.loops == 0) return stretched(i, u);
    Eigen::Vector3d t = arch(i, u);
    if (pattern_.loops == 0) {
      // A clamp or a taut neighbour determines the tangent at an end.
      if (segments_[i].begin_direction ||
          (i == 0 ? span_.start_direction.has_value() : segments_[i - 1].taut())) {
        t += std::pow(1 - u, 4) * (segments_[i].begin_tangent - arch(i, 0));
      }
      if (segments_[i].end_direction ||
          (i + 1 == chords_.size() ? span_.end_direction.has_value() : segments_[i + 1].taut())) {
        t += std::pow(u, 4) * (segments_[i].end_tangent - arch(i, 1));
      }
    }
    // A vector near zero would make the direction jump.
    if (t.norm() < 0.2) t += 0.4 * chords_[i].down;
    return t.normalized();
  }

  [[nodiscard]] Eigen::Vector3d free_end(double s, const Eigen::Vector3d& from) const {
    const double last = segments_.empty() ? span_.anchor : segments_.back().end;
    if (s >= last) return pendulum(span_, from, total_force(span_, last), s - last, 0);
    const double first = segments_.empty() ? span_.anchor : segments_.front().begin;
    return -pendulum(span_, -from, span_.force_before(first), first - s, 0);
  }

  const Span& span_;
  Pattern pattern_;
  std::vector<Segment> segments_;
  std::vector<Chord> chords_;
};

template <typename Tangent>
TangentField field(Tangent tangent) {
  return [tangent](const Eigen::VectorXd& s) {
    Eigen::Matrix3Xd tangents(3, s.size());
    for (Eigen::Index q = 0; q < s.size(); ++q) tangents.col(q) = tangent(s[q]);
    return tangents;
  };
}

/// Returns a shape from a clamp down onto an obstacle and along it. It reaches the obstacle over
/// (72 EI h / w)^(1/4), as a rod of small slopes does under its weight w from the height h, but at
/// least over 2 h. Returns std::nullopt if the obstacle is not a half-space, if the weight does not
/// press the rod onto it, if the clamp is within it or nearly normal to it, or if the rod does not
/// reach it.
std::optional<TangentField> field_on_obstacle(const Span& span, const Span::Obstacle& obstacle) {
  if (!obstacle.body.is_half_space()) return {};
  const Eigen::Vector3d normal = obstacle.body.normal();
  const double pressed = -span.mean_weight().dot(normal);
  const double height = obstacle.body.clearance(Eigen::Vector3d::Zero());
  const Eigen::Vector3d& start = *span.start_direction;
  const Eigen::Vector3d along = start - start.dot(normal) * normal;
  if (!(pressed > 0 && height >= 0 && height < span.length / 2 && along.norm() > 0.1)) return {};
  const double reach = std::max(2 * height, std::pow(72 * height / pressed, 0.25));
  if (!(reach < span.length)) return {};
  return field([start, flat = along.normalized(), normal, height, reach](double s) {
    // Also handles a start on the obstacle, where reach is zero.
    if (!(s < reach)) return flat;
    const double u = s / reach;
    const double slope = -6 * height / reach * u * (1 - u);
    return Eigen::Vector3d(
        (flat + slope * normal + std::pow(1 - u, 4) * (start - flat)).normalized());
  });
}

/// Returns the angle equal to `angle` modulo 4 pi that is nearest to zero, and the next one on the
/// other side.
std::array<double, 2> angles_of_class(double angle) {
  const double nearest = std::remainder(angle, 4 * pi);
  return {nearest, nearest - std::copysign(4 * pi, nearest)};
}

/// natural_fields() if Span::Twist::turns is given.
std::vector<TangentField> fields_with_end_frame(const Span& span) {
  std::vector<TangentField> fields;
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(257, 0, span.length);
  const Eigen::Vector3d chord = span.holds.back().offset / span.length;
  for (const TangentField& plain : start_fields(span)) {
    Eigen::Matrix3Xd tangents(3, s.size() + 2);
    tangents << *span.start_direction, plain(s).tangents, *span.end_direction;
    const std::optional<double> writhe = writhe_modulo_two(tangents, chord);
    if (!writhe) continue;
    for (const double angle : angles_of_class(2 * pi * (*span.twist->turns - *writhe))) {
      fields.emplace_back([plain, angle, length = span.length](const Eigen::VectorXd& at) {
        return StartShape(plain(at).tangents, angle / length * at);
      });
    }
  }
  return fields;
}

}  // namespace

TangentField soft_limit_field(const Span& span, int turns) {
  return field([&span, turns](double s) {
    return pendulum(span, *span.start_direction, total_force(span, 0), s, turns);
  });
}

TangentField arch_field(const Span& span) { return field(GrippedField(span, {})); }

std::vector<TangentField> start_fields(const Span& span) {
  std::vector<TangentField> fields;
  if (span.holds.empty() && span.start_direction) {
    const auto add_lying = [&](const Span::Obstacle& obstacle) {
      const std::optional<TangentField> lying = field_on_obstacle(span, obstacle);
      if (lying) fields.push_back(*lying);
    };
    std::ranges::for_each(span.soft_obstacles, add_lying);
    std::ranges::for_each(span.rigid_obstacles, add_lying);
    fields.push_back(soft_limit_field(span));
    fields.push_back(field([&span](double) { return *span.start_direction; }));
    fields.push_back(soft_limit_field(span, 1));
    return fields;
  }
  for (const bool s_shape : {false, true}) {
    for (const double sign : {1.0, -1.0}) {
      fields.push_back(field(GrippedField(span, {.s_shape = s_shape, .sign = sign})));
    }
  }
  if (!span.planar) {
    for (const double sign : {1.0, -1.0}) {
      fields.push_back(field(GrippedField(span, {.sign = sign, .out_of_plane = true})));
    }
  }
  const std::vector<Segment> segments = segments_of(span);
  if (segments.size() == 1 && !segments.front().taut()) {
    for (const int loops : {1, -1}) {
      fields.push_back(field(GrippedField(span, {.loops = loops})));
    }
  }
  return fields;
}

std::vector<TangentField> natural_fields(const Span& span) {
  if (span.twist && span.twist->turns) return fields_with_end_frame(span);
  std::vector<TangentField> fields;
  const SpanEnergy model(span, natural_shape_terms);
  const SpanShape free = model.shape(Eigen::VectorXd::Zero(model.size()));
  fields.emplace_back([free](const Eigen::VectorXd& s) {
    const Samples samples = free.sample({s.data(), static_cast<std::size_t>(s.size())});
    return StartShape(samples.tangents, roll_of(samples.tangents, samples.d1));
  });
  for (const TangentField& plain : start_fields(span)) {
    fields.push_back(plain);
    if (span.planar) continue;
    for (const double turn : {pi / 2, -pi / 2, pi, -pi}) {
      fields.emplace_back([plain, turn, length = span.length](const Eigen::VectorXd& s) {
        return StartShape(plain(s).tangents, turn / length * s);
      });
    }
  }
  return fields;
}

}  // namespace dlo::energy_model
