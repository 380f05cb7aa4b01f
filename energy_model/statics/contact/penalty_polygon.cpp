#include "contact/penalty_polygon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/clearance.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {
namespace {

/// Numbers of segments of a stiff and of a soft rod; lift-off lengths decrease with the fourth root
/// of the load.
constexpr double fewest_segments = 64;
constexpr double most_segments = 256;
/// Ratio of Segments::few to Segments::all.
constexpr double segment_share = 1.0 / 3;
/// Stretch and penetration under the loads and bending forces, divided by the rod length, and scale
/// of the bending forces [EI/l^2].
constexpr double penalty_compliance = 1e-4;
constexpr double penalty_force_scale = 40;
/// Number of neighbouring segments on an obstacle from which they count as a part in contact
/// instead of a point.
constexpr Eigen::Index least_contact_segments = 4;

/// Newton step of a polygon in equilibrium, divided by the rod length: the proof from
/// solve_polygon().
constexpr double tolerance = 1e-7;

/// Maximum numbers of evaluations of a descent in large and in small steps. A polygon that crumples
/// on its obstacle takes many more and has a higher energy than others. In small steps the path is
/// longer.
constexpr int most_evaluations = 300;
constexpr int most_evaluations_near = 3000;

/// Returns the arc lengths of a polygon's points along a span, ascending. A clamp at an end fixes
/// one more point, beyond the end.
std::vector<double> mesh_of(const Span& span, Segments segments) {
  const double load = std::max(1.0, span.total_load());
  const double count = std::clamp(24 * std::pow(load, 0.25), fewest_segments, most_segments);
  const double h = span.length / (segments == Segments::few ? segment_share * count : count);
  std::vector<double> mesh;
  if (span.start_direction) mesh.push_back(-h);
  mesh.push_back(0);
  double begin = 0;
  for (const double cut : kink_positions(span)) {
    if (cut - begin < closest_cuts) continue;
    const double parts = std::max(1.0, std::ceil((cut - begin) / h));
    for (double i = 1; i <= parts; ++i) mesh.push_back(begin + (cut - begin) * i / parts);
    begin = cut;
  }
  if (span.end_direction) mesh.push_back(span.length + h);
  return mesh;
}

/// Returns the largest clearance from the ground of the corners of a box in a body's axes.
double highest_corner(const obstacle::Body& body, const obstacle::Body& ground,
                      const std::array<Eigen::Vector3d, 2>& corners) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d at;
    for (int k = 0; k < 3; ++k) at[k] = corners[(corner >> k) % 2][k];
    highest = std::max(highest, ground.clearance(body.centre() + body.axes() * at));
  }
  return highest;
}

/// Returns a block extended into a half-space that its face touches or lies within: a polygon
/// pushed out of that face would be caught between the block and the half-space.
obstacle::Body extended_to_half_space(const obstacle::Body& body, const Span& span) {
  constexpr double flush_height = 1e-6;  // largest height of a flush face / span length
  std::array<Eigen::Vector3d, 2> corners = {body.lower().array() - body.radius(),
                                            body.upper().array() + body.radius()};
  if (!(corners[1] - corners[0]).allFinite() ||
      !(body.lower().array() < body.upper().array()).all()) {
    return body;
  }
  for (const Span::Obstacle& ground : span.rigid_obstacles) {
    if (!ground.body.is_half_space()) continue;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (const std::size_t up : {0U, 1U}) {
        const double sign = up == 1 ? 1 : -1;
        // The face has to point into the half-space.
        if (!(sign * ground.body.normal().dot(body.axes().col(axis)) < 0)) continue;
        std::array<Eigen::Vector3d, 2> face = corners;
        face[1 - up][axis] = corners[up][axis];
        if (highest_corner(body, ground.body, face) > flush_height * span.length) continue;
        corners[up][axis] += sign * span.length;
      }
    }
  }
  return obstacle::Body::box(body.centre() + body.axes() * (corners[0] + corners[1]) / 2,
                             body.axes(), corners[1] - corners[0], body.radius());
}

class PenaltyRelaxation {
 public:
  PenaltyRelaxation(const Span& span, Segments segments, Descent descent)
      : span_(span), descent_(descent), mesh_(mesh_of(span, segments)) {
    const std::size_t count = mesh_.size();
    const double stiff = (penalty_force_scale + span.total_load()) / penalty_compliance;
    problem_.rest_lengths.resize(static_cast<Eigen::Index>(count) - 1);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      problem_.rest_lengths[static_cast<Eigen::Index>(i)] = mesh_[i + 1] - mesh_[i];
    }
    problem_.stretch_stiffness = stiff;
    problem_.stiffness = round_stiffness(span.stiffness);
    place_joints();
    place_forces();
    set_held_points();
    for (const Span::SoftObstacle& obstacle : span.soft_obstacles) {
      add_obstacle(obstacle, obstacle.stiffness * segment());
    }
    for (const Span::Obstacle& obstacle : span.rigid_obstacles) add_obstacle(obstacle, stiff);
    if (span.twist && !span.has_material_directors()) {
      PolygonTwist& twist = problem_.twists.emplace_back();
      twist.last_segment = problem_.rest_lengths.size() - 1;
      twist.first_d1 = span.first_d1(*span.start_direction);
      twist.last_d1 = span.twist->end_d1;
      twist.compliance = span.length / span.twist->stiffness;
    }
  }

  /// Whether a shape has points within the core of a rigid obstacle other than a half-space.
  [[nodiscard]] bool passes_through_core(const TangentField& start) const {
    const Eigen::Matrix3Xd points = points_of(start);
    return std::ranges::any_of(span_.rigid_obstacles, [&](const auto& obstacle) {
      const obstacle::Body& body = obstacle.body;
      return !body.is_half_space() && body.clearances(points).minCoeff() < -body.radius();
    });
  }

  [[nodiscard]] PenaltyPolygon relax_from(const TangentField& start, const Deadline& deadline) {
    if (!problem_.twists.empty()) problem_.twists[0].angle = start(Eigen::VectorXd::Zero(1)).twist;
    return relax_from(points_of(start), Stages::yes, deadline);
  }

  [[nodiscard]] PenaltyPolygon relax_from(const PenaltyPolygon& coarse, const Deadline& deadline) {
    if (!problem_.twists.empty()) problem_.twists[0].angle = coarse.twist;
    return relax_from(points_between(coarse), Stages::no, deadline);
  }

 private:
  /// Whether stretch is soft in the first stages, for a start far from equilibrium.
  enum class Stages { yes, no };

  /// Separates neighbouring points that coincide: a start may turn back within a segment.
  void separate(Eigen::Matrix3Xd& points) const {
    constexpr double least_gap_share = 1e-9;  // divided by the length at rest
    for (Eigen::Index i = 1; i < points.cols(); ++i) {
      const double gap = least_gap_share * problem_.rest_lengths[i - 1];
      if ((points.col(i) - points.col(i - 1)).norm() >= gap) continue;
      points.rightCols(points.cols() - i).row(0).array() += gap;
    }
  }

  [[nodiscard]] PenaltyPolygon relax_from(Eigen::Matrix3Xd start, Stages stages,
                                          const Deadline& deadline) {
    separate(start);
    PolygonOptions options;
    options.tolerance = tolerance;
    const bool is_near = descent_ == Descent::near;
    options.max_evaluations = is_near ? most_evaluations_near : most_evaluations;
    options.in_stages = stages == Stages::yes && !is_near;
    options.project_hessian = !is_near;
    options.time_limit = std::max(1e-3, deadline.remaining());
    const PolygonResult found = solve_polygon(problem_, start, options);
    PenaltyPolygon result;
    result.evaluations = found.evaluations;
    result.energy = found.energy;
    result.at_rest = succeeded(found.status);
    result.s = mesh_;
    result.points = found.points;
    if (!found.twists.empty()) result.twist = found.twists[0];
    const Eigen::Index n = problem_.rest_lengths.size();
    result.middles.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) result.middles[i] = (s(i) + s(i + 1)) / 2;
    result.tangents = (found.points.rightCols(n) - found.points.leftCols(n)).colwise().normalized();
    for (const Span::Obstacle& obstacle : span_.rigid_obstacles) {
      add_contacts(obstacle, found.points, result);
    }
    std::ranges::sort(result.contacts, {}, &Span::Contact::begin);
    return result;
  }

  /// Returns about the mean length of a segment.
  [[nodiscard]] double segment() const { return span_.length / static_cast<double>(mesh_.size()); }

  [[nodiscard]] int samples_of(const Span::Obstacle& obstacle) const {
    return obstacle::samples_per_segment(obstacle.body, segment());
  }

  [[nodiscard]] double s(Eigen::Index i) const { return mesh_[static_cast<std::size_t>(i)]; }

  /// Returns EI of a round rod with about the same bending; in the plane EI about its normal.
  [[nodiscard]] double round_stiffness(const Eigen::Vector3d& stiffness) const {
    return span_.planar ? stiffness.x() : std::sqrt(stiffness.x() * stiffness.y());
  }

  void add_obstacle(const Span::Obstacle& obstacle, double stiffness) {
    problem_.obstacles.push_back(
        {extended_to_half_space(obstacle.body, span_), stiffness, samples_of(obstacle)});
  }

  [[nodiscard]] Eigen::Index point_at(double at) const {
    const auto nearest =
        std::ranges::min_element(mesh_, {}, [at](double s) { return std::abs(s - at); });
    return nearest - mesh_.begin();
  }

  void place_joints() {
    const Eigen::Index joints = problem_.rest_lengths.size() - 1;
    if (!span_.parts.empty()) problem_.stiffnesses.setConstant(joints, problem_.stiffness);
    if (span_.planar && !span_.natural.empty()) problem_.natural_turns.setZero(joints);
    for (Eigen::Index i = 0; i < joints; ++i) {
      const double begin = (s(i) + s(i + 1)) / 2;
      const double end = (s(i + 1) + s(i + 2)) / 2;
      for (const Span::Part& part : span_.parts) {
        const bool within = s(i + 1) >= part.begin && s(i + 1) <= part.end;
        if (within) problem_.stiffnesses[i] = round_stiffness(part.stiffness);
      }
      if (problem_.natural_turns.size() > 0) {
        problem_.natural_turns[i] =
            span_.natural.integral(end).x() - span_.natural.integral(begin).x();
      }
    }
  }

  void place_forces() {
    const auto count = static_cast<Eigen::Index>(mesh_.size());
    problem_.node_forces.setZero(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double begin = i == 0 ? 0 : std::max(0.0, (s(i - 1) + s(i)) / 2);
      const double end =
          i + 1 == count ? span_.length : std::min(span_.length, (s(i) + s(i + 1)) / 2);
      if (end > begin) problem_.node_forces.col(i) = span_.weight_between(begin, end);
    }
    for (const Span::Load& load : span_.loads) {
      problem_.node_forces.col(point_at(load.at)) += load.force;
    }
  }

  void set_held_points() {
    const auto last = static_cast<Eigen::Index>(mesh_.size()) - 1;
    const auto hold_point = [&](Eigen::Index point, const Eigen::Vector3d& position) {
      const bool held = std::ranges::any_of(
          problem_.held, [point](const HeldPoint& other) { return other.point == point; });
      if (!held) problem_.held.push_back({point, position});
    };
    if (span_.start_direction) hold_point(0, -problem_.rest_lengths[0] * *span_.start_direction);
    hold_point(point_at(span_.anchor), Eigen::Vector3d::Zero());
    for (const Span::Hold& held : span_.holds) {
      const Eigen::Index point = point_at(held.at);
      hold_point(point, held.offset);
      if (!held.direction || point == 0) continue;
      // The clamp inside the span also fixes the point before it.
      hold_point(point - 1, held.offset - problem_.rest_lengths[point - 1] * *held.direction);
    }
    if (!span_.end_direction) return;
    hold_point(last,
               span_.holds.back().offset + problem_.rest_lengths[last - 1] * *span_.end_direction);
  }

  [[nodiscard]] Eigen::Matrix3Xd points_of(const TangentField& start) const {
    const Eigen::Index n = problem_.rest_lengths.size();
    Eigen::VectorXd middles(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      middles[i] = std::clamp((s(i) + s(i + 1)) / 2, 0.0, span_.length);
    }
    const Eigen::Matrix3Xd tangents = start(middles).tangents;
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, n + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      points.col(i + 1) = points.col(i) + problem_.rest_lengths[i] * tangents.col(i);
    }
    const Eigen::Vector3d anchor = points.col(point_at(span_.anchor));
    points.colwise() -= anchor;
    if (span_.planar) points.row(2).setZero();
    return points;
  }

  /// Interpolates a coarser polygon's points by cubics, which stretch segments less than chords do.
  [[nodiscard]] Eigen::Matrix3Xd points_between(const PenaltyPolygon& coarse) const {
    const auto last = static_cast<Eigen::Index>(coarse.s.size()) - 1;
    const auto at = [&](Eigen::Index i) { return coarse.s[static_cast<std::size_t>(i)]; };
    const auto slope = [&](Eigen::Index i) {
      const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
      const Eigen::Index after = std::min(i + 1, last);
      return Eigen::Vector3d((coarse.points.col(after) - coarse.points.col(before)) /
                             (at(after) - at(before)));
    };
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(mesh_.size()));
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const auto above = std::upper_bound(coarse.s.begin(), coarse.s.end(), s(k));
      const Eigen::Index i = std::clamp<Eigen::Index>(above - coarse.s.begin() - 1, 0, last - 1);
      const double h = at(i + 1) - at(i);
      const double x = (s(k) - at(i)) / h;
      points.col(k) = (1 + 2 * x) * (1 - x) * (1 - x) * coarse.points.col(i) +
                      x * x * (3 - 2 * x) * coarse.points.col(i + 1) +
                      h * x * (1 - x) * ((1 - x) * slope(i) - x * slope(i + 1));
    }
    return points;
  }

  /// Returns the arc length of a short run as a contact point: an end of the rod, or the mean of
  /// its arc lengths weighted by depth.
  /// @param moment  sum of depths times arc lengths
  [[nodiscard]] double contact_point(double begin, double end, double depth, double moment) const {
    if (begin == 0) return 0;
    if (end == span_.length) return span_.length;
    return depth > 0 ? moment / depth : begin;
  }

  /// Adds the contacts of a rigid obstacle: runs of consecutive points within it, each at one of
  /// its features. A short run at a grip is omitted.
  void add_contacts(const Span::Obstacle& obstacle, const Eigen::Matrix3Xd& points,
                    PenaltyPolygon& result) const {
    // The clearance is also sampled within segments.
    const int samples = samples_of(obstacle);
    const Eigen::Index count = samples * (points.cols() - 1) + 1;
    std::vector<double> at;
    Eigen::VectorXd clearance(count);
    std::vector<int> feature;
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index i = std::min(k / samples, points.cols() - 2);
      const double share = static_cast<double>(k - i * samples) / samples;
      at.push_back((1 - share) * s(i) + share * s(i + 1));
      const Eigen::Vector3d point = (1 - share) * points.col(i) + share * points.col(i + 1);
      clearance[k] = obstacle.body.clearance(point);
      feature.push_back(obstacle.body.feature(point));
    }
    // A grip may hold the rod on the surface; no spring force acts on a fixed point there.
    const auto on = [&](Eigen::Index k) {
      return at[k] >= 0 && at[k] <= span_.length &&
             (clearance[k] <= 0 || (is_held(span_, at[k]) && clearance[k] <= contact_tolerance));
    };
    for (Eigen::Index i = 0; i < count; ++i) {
      if (!on(i)) continue;
      const Eigen::Index first = i;
      const auto next_to = [&](Eigen::Index k) { return feature[static_cast<std::size_t>(k)]; };
      while (i + 1 < count && on(i + 1) && next_to(i + 1) == next_to(first)) ++i;
      Span::Contact contact{obstacle, at[first], at[i], true, next_to(first)};
      if (i - first + 1 < least_contact_segments * samples) {
        double depth = 0;
        double moment = 0;
        for (Eigen::Index k = first; k <= i; ++k) {
          depth -= clearance[k];
          moment -= clearance[k] * at[k];
        }
        contact.begin = contact.end = contact_point(at[first], at[i], depth, moment);
        if (is_held(span_, contact.begin)) continue;
      }
      result.contacts.push_back(contact);
    }
  }

  const Span& span_;
  Descent descent_;
  std::vector<double> mesh_;  // arc lengths of the points
  PolygonProblem problem_;
};

}  // namespace

TangentField PenaltyPolygon::field() const {
  return [middles = middles, tangents = tangents, twist = twist](const Eigen::VectorXd& at) {
    StartShape result(Eigen::Matrix3Xd(3, at.size()));
    for (Eigen::Index q = 0; q < at.size(); ++q) {
      result.tangents.col(q) = tangent_between(middles, tangents, at[q]);
    }
    result.twist = twist;
    return result;
  };
}

PenaltyPolygon relax_on_obstacles(const Span& span, const TangentField& start, Segments segments,
                                  const Deadline& deadline, Descent descent) {
  PenaltyRelaxation resting(span, segments, descent);
  if (!resting.passes_through_core(start)) return resting.relax_from(start, deadline);
  TangentField from = start;
  int evaluations = 0;
  for (const double round : {1.0, 0.75, 0.5, 0.25}) {
    Span rounder = span;
    for (Span::Obstacle& obstacle : rounder.rigid_obstacles) {
      obstacle.body = obstacle.body.with_rounded_edges(round);
    }
    const PenaltyPolygon before =
        PenaltyRelaxation(rounder, segments, descent).relax_from(from, deadline);
    evaluations += before.evaluations;
    from = before.field();
  }
  PenaltyPolygon result = resting.relax_from(from, deadline);
  result.evaluations += evaluations;
  return result;
}

PenaltyPolygon relax_refined(const Span& span, const PenaltyPolygon& coarse,
                             const Deadline& deadline, Descent descent) {
  return PenaltyRelaxation(span, Segments::all, descent).relax_from(coarse, deadline);
}

}  // namespace dlo::energy_model
