#include "shape/aligner.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/problem.hpp"
#include "shape/curve.hpp"
#include "shape/shape_measure.hpp"

namespace dlo::compare {
namespace {

/// Largest number of points used to find initial poses.
constexpr Eigen::Index most_coarse_points = 200;
/// Smallest relative decrease of the mean square in one step; below it the iteration ends.
constexpr double least_squares_gain = 1e-9;
/// Ratio of two mean squares of thinned points from which the worse direction is rejected without
/// using all points. It is larger than what noise in the omitted points can cause.
constexpr double rejected_ratio = 4;
/// Relative difference between the lengths of the file and the rod up to which the ends of the file
/// are the ends of the rod. It covers the error of lengths along a dozen points of a smooth rod,
/// and single precision.
constexpr double end_slack = 1e-3;
/// Share of the rod by which a file may be shorter and still be treated as the whole rod.
constexpr double whole_rod_slack = 0.03;
/// Number of positions along the rod at which a file that covers a part of it is tried.
constexpr int coarse_places_along = 5;

double weighted_mean_square(const Eigen::Matrix3Xd& gaps, const Eigen::VectorXd& weight) {
  return gaps.colwise().squaredNorm().transpose().dot(weight);
}

}  // namespace

Aligner::Aligner(const MeasuredShape& shape, double length, const AlignOptions& options)
    : length_(length), options_(options) {
  if (options.pose != PoseFreedom::known && shape.points.cols() < 3) {
    throw InputError(fmt::format("{}: {} points (allowed with a frame to be found: 3 or more)",
                                 shape.file, shape.points.cols()));
  }
  rule_ = arc_length_rule(shape, options.arc_lengths);
  Shape& along = file_points_[0];
  if (rule_ == ArcLengths::file) {
    along = shape_of_file(shape, length);
  } else {
    along.points = shape.points;
    along.arc_length = arc_lengths_along(along.points);
    const double total = along.arc_length.back();
    covers_whole_rod_ = total >= (1 - whole_rod_slack) * length;
    // The polyline of a chain is as long as the rod; for points of a curve the arcs are. Measured
    // points, which have equal weights, determine the ends only up to their noise.
    has_rod_ends_ = options.weights == PointWeights::by_length &&
                    total >= (1 - end_slack) * length &&
                    polyline_length(along.points) <= (1 + end_slack) * length;
    if (rule_ == ArcLengths::chord || total > length) along = stretched_to_rod(std::move(along));
  }
  file_points_[1].points = along.points.rowwise().reverse();
  const double end = rule_ == ArcLengths::nearest ? along.arc_length.back() : length;
  std::vector<double>& against = file_points_[1].arc_length;
  against.assign(along.arc_length.rbegin(), along.arc_length.rend());
  for (double& s : against) s = end - s;
}

Shape Aligner::stretched_to_rod(Shape way) const {
  const double first = way.arc_length.front();
  const double total = way.arc_length.back() - first;
  for (double& s : way.arc_length) s = std::min((s - first) / total * length_, length_);
  return way;
}

bool Aligner::is_dense() const { return points() > most_coarse_points; }

Eigen::Index Aligner::free_coordinates() const {
  constexpr Eigen::Index counts[] = {0, 3, 4, 6};
  return counts[static_cast<std::size_t>(options_.pose)];
}

Eigen::VectorXd Aligner::weights(const std::vector<double>& s,
                                 const Eigen::Matrix3Xd& points) const {
  if (options_.weights == PointWeights::by_length) return point_weights(s, points);
  const auto count = static_cast<Eigen::Index>(s.size());
  return Eigen::VectorXd::Constant(count, 1 / static_cast<double>(count));
}

RigidMotion Aligner::closest_pose(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                  const Eigen::VectorXd& weight) const {
  RigidMotion pose;
  if (options_.pose == PoseFreedom::known) return pose;
  const Eigen::Vector3d from_centre = from * weight;
  const Eigen::Vector3d to_centre = to * weight;
  const Eigen::Matrix3d moments =
      (from.colwise() - from_centre) * weight.asDiagonal() * (to.colwise() - to_centre).transpose();
  if (options_.pose == PoseFreedom::upright) {
    // Among the rotations by an angle a about up, maximise cos a C + sin a S.
    const Eigen::Vector3d& up = options_.up;
    const double cosine = moments.trace() - up.dot(moments * up);
    const Eigen::Vector3d twist(moments(1, 2) - moments(2, 1), moments(2, 0) - moments(0, 2),
                                moments(0, 1) - moments(1, 0));
    pose.rotation = Eigen::AngleAxisd(std::atan2(up.dot(twist), cosine), up).toRotationMatrix();
  } else if (options_.pose == PoseFreedom::rigid) {
    // Kabsch: the nearest rotation, which is never a reflection.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    signs[2] = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
    pose.rotation = svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
  }
  pose.translation = to_centre - pose.rotation * from_centre;
  return pose;
}

Aligner::Placement Aligner::fit_pose_at_given_arc_lengths(const Shape& way,
                                                          const Curve& curve) const {
  const Eigen::Matrix3Xd reference = curve.points(way.arc_length);
  Placement placed;
  placed.arc_length = way.arc_length;
  const Eigen::VectorXd weight = weights(way.arc_length, way.points);
  placed.pose = closest_pose(way.points, reference, weight);
  placed.mean_square = weighted_mean_square(placed.pose.applied(way.points) - reference, weight);
  return placed;
}

Shape Aligner::thinned(const Shape& way) {
  const Eigen::Index every = (way.points.cols() + most_coarse_points - 1) / most_coarse_points;
  const Eigen::Index count = (way.points.cols() - 1) / every + 1;
  Shape result{std::vector<double>(static_cast<std::size_t>(count)), Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    result.points.col(i) = way.points.col(i * every);
    result.arc_length[static_cast<std::size_t>(i)] =
        way.arc_length[static_cast<std::size_t>(i * every)];
  }
  return result;
}

std::vector<Aligner::Placement> Aligner::coarse_placements(const Shape& way,
                                                           const Curve& curve) const {
  const Shape thin = thinned(way);
  const Eigen::Matrix3Xd& points = thin.points;
  const double slack = length_ - way.arc_length.back();
  const int places = slack > whole_rod_slack * length_ ? coarse_places_along : 1;
  std::vector<Placement> result;
  for (int place = 0; place < places; ++place) {
    Placement placed;
    placed.arc_length = thin.arc_length;
    const double offset = places > 1 ? slack * place / (places - 1) : slack / 2;
    for (double& s : placed.arc_length) s = std::clamp(s + offset, 0.0, length_);
    for (int round = 0; round < 3; ++round) {
      placed.pose =
          closest_pose(points, curve.points(placed.arc_length), weights(placed.arc_length, points));
      placed.arc_length = curve.nearest_in_order(placed.pose.applied(points));
    }
    placed.mean_square =
        weighted_mean_square(placed.pose.applied(points) - curve.points(placed.arc_length),
                             weights(placed.arc_length, points));
    result.push_back(std::move(placed));
  }
  std::ranges::stable_sort(result, {}, &Placement::mean_square);
  return result;
}

Aligner::Placement Aligner::refine_placement(const Shape& way, const Curve& curve,
                                             const RigidMotion& start) const {
  Placement placed;
  placed.pose = start;
  constexpr int most_rounds = 6;
  double before = INFINITY;
  for (int round = 0; round < most_rounds; ++round) {
    placed.arc_length = curve.nearest_in_order(placed.pose.applied(way.points));
    gauss_newton(way.points, curve, placed);
    if (free_coordinates() == 0) break;
    if (!(placed.mean_square < (1 - 1e-6) * before)) break;
    before = placed.mean_square;
  }
  return placed;
}

void Aligner::gauss_newton(const Eigen::Matrix3Xd& points, const Curve& curve,
                           Placement& placed) const {
  const Eigen::VectorXd weight = weights(placed.arc_length, points);
  const auto cost = [&](const Eigen::Matrix3Xd& moved, const std::vector<double>& s) {
    return (moved - curve.points(s)).colwise().squaredNorm().transpose().dot(weight);
  };
  Eigen::Matrix3Xd moved = placed.pose.applied(points);
  placed.mean_square = cost(moved, placed.arc_length);
  const Eigen::Index free = free_coordinates();
  if (free == 0) return;
  const Eigen::Index turns = free - 3;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (options_.pose == PoseFreedom::upright) axes.col(0) = options_.up;
  constexpr int most_steps = 40;
  double damping = 1e-9;
  for (int step = 0; step < most_steps && damping < 1e3; ++step) {
    const Eigen::Vector3d centre = moved * weight;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(free, free);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(free);
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 6> J(3, free);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const double s = placed.arc_length[static_cast<std::size_t>(i)];
      const Eigen::Vector3d gap = moved.col(i) - curve.point(s);
      const Eigen::Vector3d t = curve.tangent(s).normalized();
      const Eigen::Vector3d arm = (moved.col(i) - centre) / length_;
      for (Eigen::Index k = 0; k < turns; ++k) J.col(k) = axes.col(k).cross(arm);
      J.rightCols<3>().setIdentity();
      // The arc length follows the point along the curve, but not past an end.
      const bool past_end = (s <= 0 && gap.dot(t) < 0) || (s >= length_ && gap.dot(t) > 0);
      if (!past_end) J -= t * (t.transpose() * J).eval();
      A += weight[i] * J.transpose() * J;
      b -= weight[i] * J.transpose() * gap;
    }
    A.diagonal().array() += damping;
    const Eigen::VectorXd move = A.ldlt().solve(b);
    if (!move.allFinite()) return;
    // A step that gains no more than rounding would be retried at every damping.
    if (!(b.dot(move) > least_squares_gain * placed.mean_square)) return;
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < turns; ++k) turn += move[k] / length_ * axes.col(k);
    const Eigen::Matrix3d rotation =
        turn.norm() > 0 ? Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix()
                        : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    const RigidMotion next{rotation * placed.pose.rotation,
                           rotation * (placed.pose.translation - centre) + centre + move.tail<3>()};
    const Eigen::Matrix3Xd next_moved = next.applied(points);
    std::vector<double> next_s(placed.arc_length);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      double& s = next_s[static_cast<std::size_t>(i)];
      s = curve.nearest(next_moved.col(i), s);
    }
    const double next_cost = cost(next_moved, next_s);
    if (!(next_cost < placed.mean_square)) {
      damping *= 30;
      continue;
    }
    const bool converged = next_cost > (1 - least_squares_gain) * placed.mean_square;
    placed = {next, std::move(next_s), next_cost};
    moved = next_moved;
    damping = std::max(damping / 10, 1e-12);
    if (converged) return;
  }
}

Aligner::Placement Aligner::best_placement(const Shape& way, const Curve& curve) const {
  if (!has_free_arc_lengths()) return fit_pose_at_given_arc_lengths(way, curve);
  if (options_.pose == PoseFreedom::known) return refine_placement(way, curve, RigidMotion());
  const Placement thinned_place = best_placement_of_thinned(way, curve);
  return is_dense() ? refine_placement(way, curve, thinned_place.pose) : thinned_place;
}

Aligner::Placement Aligner::best_placement_of_thinned(const Shape& way, const Curve& curve) const {
  const Shape thin = thinned(way);
  const std::vector<Placement> coarse = coarse_placements(way, curve);
  Placement best = refine_placement(thin, curve, coarse.front().pose);
  if (coarse.size() > 1) {
    Placement second = refine_placement(thin, curve, coarse[1].pose);
    if (second.mean_square < best.mean_square) best = std::move(second);
  }
  return best;
}

Alignment Aligner::finished(const Placement& placed, bool reversed, const Curve& curve) const {
  Alignment result;
  result.pose = placed.pose;
  result.reversed = reversed;
  result.arc_lengths = rule_;
  result.shape.arc_length = placed.arc_length;
  // Within an interval of the curve, noise may have swapped neighbours.
  std::vector<double>& s = result.shape.arc_length;
  std::partial_sum(s.begin(), s.end(), s.begin(),
                   [](double before, double next) { return std::max(before, next); });
  if (has_rod_ends_) {
    s.front() = 0;
    s.back() = length_;
  }
  result.shape.points = placed.pose.applied(file_points_[reversed ? 1 : 0].points);
  const Eigen::Matrix3Xd gaps = result.shape.points - curve.points(s);
  result.rms_m = std::sqrt(weighted_mean_square(gaps, weights(s, result.shape.points)));
  result.mean_square =
      (result.shape.points - curve.points(placed.arc_length)).colwise().squaredNorm().mean();
  return result;
}

double Aligner::reported_distance(const Alignment& aligned, const Curve& curve,
                                  Measured& measured) const {
  const Reference reference = [&curve](std::span<const double> s) {
    energy_model::Samples samples;
    samples.points = curve.points({s.begin(), s.end()});
    return samples;
  };
  measured = measure(aligned, reference, length_);
  return covers_whole_rod_ ? whole_rod_distances(measured, aligned, reference, length_).rms_m
                           : measured.rms_m;
}

Alignment Aligner::refine_by_reported_distance(const Shape& way, RigidMotion pose,
                                               const Curve& curve) const {
  constexpr int most_rounds = 50;
  Alignment best;
  best.rms_m = INFINITY;
  for (int round = 0; round < most_rounds; ++round) {
    Alignment next;
    next.pose = pose;
    next.shape.points = pose.applied(way.points);
    next.shape.arc_length = curve.nearest_in_order(next.shape.points);
    Measured measured;
    next.rms_m = reported_distance(next, curve, measured);
    if (!(next.rms_m < (1 - 1e-6) * best.rms_m)) break;
    best = std::move(next);
    pose = closest_pose(way.points, measured.reference,
                        weights(measured.arc_length, best.shape.points));
  }
  return best;
}

Alignment Aligner::aligned(std::size_t way, const Placement& nearest, const Curve& curve) const {
  Alignment result = finished(nearest, way == 1, curve);
  const bool weights_by_length = options_.weights == PointWeights::by_length;
  if (!has_free_arc_lengths() || free_coordinates() == 0 || !weights_by_length) return result;
  RigidMotion pose = nearest.pose;
  if (is_dense()) pose = refine_by_reported_distance(thinned(file_points_[way]), pose, curve).pose;
  Placement placed{.pose = refine_by_reported_distance(file_points_[way], pose, curve).pose};
  placed.arc_length = curve.nearest_in_order(placed.pose.applied(file_points_[way].points));
  result = finished(placed, way == 1, curve);
  Measured measured;
  result.rms_m = reported_distance(result, curve, measured);
  if (!covers_whole_rod_) return result;
  Alignment whole = finished(
      fit_pose_at_given_arc_lengths(stretched_to_rod(file_points_[way]), curve), way == 1, curve);
  whole.arc_lengths = ArcLengths::chord;
  return whole.rms_m < result.rms_m ? whole : result;
}

Alignment Aligner::align(const Curve& curve) const {
  if (is_dense() && has_free_arc_lengths() && free_coordinates() > 0) {
    // A part of the points suffices to reject a direction that is clearly wrong.
    const std::array thinned_places = {best_placement_of_thinned(file_points_[0], curve),
                                       best_placement_of_thinned(file_points_[1], curve)};
    for (const std::size_t way : {0, 1}) {
      const Placement& other = thinned_places[1 - way];
      if (!(other.mean_square > rejected_ratio * thinned_places[way].mean_square)) continue;
      Alignment result =
          aligned(way, refine_placement(file_points_[way], curve, thinned_places[way].pose), curve);
      result.opposite_direction_rms_m = std::sqrt(other.mean_square);
      return result;
    }
  }
  // The directions are compared with arc lengths in order. Points that run the other way fit well
  // only out of order.
  Alignment along = aligned(0, best_placement(file_points_[0], curve), curve);
  Alignment against = aligned(1, best_placement(file_points_[1], curve), curve);
  // If both directions fit equally well, the file runs along the rod.
  const double rounding = 1e-12 * length_;
  if (against.rms_m + rounding < (1 - 1e-9) * along.rms_m) std::swap(along, against);
  along.opposite_direction_rms_m = against.rms_m;
  return along;
}

Eigen::Vector3d upward_direction(const Scene& scene, PoseFreedom pose) {
  if (pose != PoseFreedom::upright) return Eigen::Vector3d::UnitY();
  if (!(scene.gravity.norm() > 0)) {
    throw InputError(fmt::format(
        "{}: no gravity, so no frame is upright (allowed: translation, rigid)", scene.file));
  }
  return -scene.gravity.normalized();
}

Alignment align(const MeasuredShape& shape, const Reference& reference, double length,
                const AlignOptions& options) {
  return Aligner(shape, length, options).align(Curve(reference, length));
}

}  // namespace dlo::compare
