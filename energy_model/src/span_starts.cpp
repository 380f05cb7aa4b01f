#include "span_starts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

Eigen::Vector3d total_force(const Span& span, double beyond) {
  Eigen::Vector3d n = (span.length - beyond) * span.weight;
  for (const Span::Load& load : span.loads) {
    if (load.at > beyond) n += load.force;
  }
  return n;
}

/// A unit vector across `direction`, in the plane of a planar span.
Eigen::Vector3d across(const Span& span, const Eigen::Vector3d& direction) {
  if (span.planar) return Eigen::Vector3d(-direction.y(), direction.x(), 0).normalized();
  return direction.unitOrthogonal();
}

/// Turns from `from` to the force as a soft rod does; `turns` whole turns more than the shorter
/// way.
Eigen::Vector3d pendulum(const Span& span, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& force, double distance, int turns) {
  const double size = force.norm();
  if (!(size > 0)) return from;
  const Eigen::Vector3d axis = force / size;
  Eigen::Vector3d side = from - from.dot(axis) * axis;
  // Against the force both ways are as short; in a plane the rod falls towards its +y.
  if (side.norm() < 1e-9) side = -across(span, axis);
  side.normalize();
  const double turn = std::atan2(from.dot(side), from.dot(axis)) - 2 * pi * turns;
  const double psi = 4 * std::atan(std::tan(turn / 4) * std::exp(-std::sqrt(size) * distance));
  return std::cos(psi) * axis + std::sin(psi) * side;
}

/// A with J_0(A) = chord over arc length: the amplitude of a sine in angle that has this slack.
double slack_amplitude(double ratio) {
  double low = 0;
  double high = 2.404825557695773;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (std::cyl_bessel_j(0, middle) > ratio ? low : high) = middle;
  }
  return low;
}

struct Waypoint {
  double at;
  Eigen::Vector3d position;
};

std::vector<Waypoint> waypoints(const Span& span) {
  std::vector<Waypoint> points = {{span.anchor, Eigen::Vector3d::Zero()}};
  for (const Span::Hold& hold : span.holds) points.push_back({hold.at, hold.offset});
  std::sort(points.begin(), points.end(),
            [](const Waypoint& a, const Waypoint& b) { return a.at < b.at; });
  return points;
}

struct Pattern {
  bool s_shape = false;
  double sign = 1;
  int loops = 0;
  bool out_of_plane = false;
};

/// Tangents between grips: chords with arches on them, bent into the clamps.
class GrippedField {
 public:
  GrippedField(const Span& span, const Pattern& pattern)
      : span_(span), pattern_(pattern), points_(waypoints(span)) {
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      const Eigen::Vector3d chord = points_[i + 1].position - points_[i].position;
      const double arc = points_[i + 1].at - points_[i].at;
      const double ratio = chord.norm() / arc;
      Eigen::Vector3d along = Eigen::Vector3d::UnitX();
      if (ratio > 1e-6) {
        along = chord.normalized();
      } else if (span.start_direction) {
        along = *span.start_direction;
      }
      Eigen::Vector3d down = span.weight - span.weight.dot(along) * along;
      if (down.norm() < 1e-9 * (1 + span.weight.norm())) down = across(span, along);
      down.normalize();
      if (pattern.out_of_plane) down = along.cross(down);
      chords_.push_back({along, down, slack_amplitude(std::min(1.0, ratio))});
    }
  }

  [[nodiscard]] Eigen::Vector3d operator()(double s) const {
    if (chords_.empty()) return free_end(s, Eigen::Vector3d::UnitX());
    if (s < points_.front().at) return free_end(s, bent(0, 0));
    if (s > points_.back().at) return free_end(s, bent(chords_.size() - 1, 1));
    std::size_t i = 0;
    while (i + 1 < chords_.size() && s > points_[i + 1].at) ++i;
    return bent(i, (s - points_[i].at) / (points_[i + 1].at - points_[i].at));
  }

 private:
  struct Chord {
    Eigen::Vector3d along, down;
    double amplitude;
  };

  [[nodiscard]] Eigen::Vector3d arch(std::size_t i, double u) const {
    const Chord& chord = chords_[i];
    // An arch leaves the chord's line towards `down` and comes back; an S crosses it.
    const double wave = pattern_.s_shape ? std::cos(2 * pi * u) : std::sin(2 * pi * u);
    double angle = pattern_.sign * chord.amplitude * wave;
    angle += 2 * pi * pattern_.loops * u;
    return std::cos(angle) * chord.along + std::sin(angle) * chord.down;
  }

  [[nodiscard]] Eigen::Vector3d bent(std::size_t i, double u) const {
    Eigen::Vector3d t = arch(i, u);
    if (pattern_.loops == 0) {
      if (i == 0 && span_.start_direction) {
        t += std::pow(1 - u, 4) * (*span_.start_direction - arch(0, 0));
      }
      if (i + 1 == chords_.size() && span_.end_direction) {
        t += std::pow(u, 4) * (*span_.end_direction - arch(i, 1));
      }
    }
    // Through zero the direction would jump.
    if (t.norm() < 0.2) t += 0.4 * chords_[i].down;
    return t.normalized();
  }

  [[nodiscard]] Eigen::Vector3d free_end(double s, const Eigen::Vector3d& from) const {
    if (s >= points_.back().at) {
      return pendulum(span_, from, total_force(span_, points_.back().at), s - points_.back().at, 0);
    }
    Eigen::Vector3d before = points_.front().at * span_.weight;
    for (const Span::Load& load : span_.loads) {
      if (load.at < points_.front().at) before += load.force;
    }
    return -pendulum(span_, -from, before, points_.front().at - s, 0);
  }

  const Span& span_;
  Pattern pattern_;
  std::vector<Waypoint> points_;
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

}  // namespace

TangentField soft_field(const Span& span) {
  return field([&span](double s) {
    return pendulum(span, *span.start_direction, total_force(span, 0), s, 0);
  });
}

std::vector<TangentField> start_fields(const Span& span) {
  std::vector<TangentField> fields;
  if (span.holds.empty() && span.start_direction) {
    fields.push_back(soft_field(span));
    fields.push_back(field([&span](double) { return *span.start_direction; }));
    fields.push_back(field([&span](double s) {
      return pendulum(span, *span.start_direction, total_force(span, 0), s, 1);
    }));
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
  if (span.holds.size() == 1) {
    for (const int loops : {1, -1}) {
      fields.push_back(field(GrippedField(span, {.loops = loops})));
    }
  }
  return fields;
}

}  // namespace dlo::energy_model
