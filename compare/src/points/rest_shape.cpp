#include "dlo/compare/rest_shape.hpp"

#include <fmt/format.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/gsl.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Largest number of points used in a fit. More points take time in proportion and improve the arcs
/// little.
constexpr Index most_fitted_points = 150;
/// Distance from a plane, as a share of the length, up to which points lie in the plane.
constexpr double plane_share = 1e-6;
/// Square root of the sum of squared residuals below which no more arcs are tried.
constexpr double sufficient_accuracy = 1e-7;
/// Largest relative difference between the length of the points' curve and that of the rod.
constexpr double length_tolerance = 0.05;
/// Weight of an angle [rad] in the residual, compared with a distance divided by the length: the
/// length of the shortest arcs, as a share of the rod.
constexpr double angle_weight = 1.0 / most_rest_arcs;

/// Position and frame of a rod with the strains of an arc, at some arc length.
struct ArcPlace {
  Vector3d point;
  Matrix3d frame;  // d1, d2, t
};

/// Points to fit by arcs, and what is known of their arc lengths.
struct ArcTarget {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd d1;  // first directors of the frames at the points; empty: arcs have no twist
  std::vector<double> s;
  bool has_arc_lengths = false;  // false: inner points have the arc length of the nearest point
  double length = 0;
  bool planar = false;
  Vector3d normal;  // unit normal of the plane of the points, or nearest to them

  /// Whether arcs may have a twist, which only frames determine.
  [[nodiscard]] bool twists() const { return d1.cols() > 0 && !planar; }
  /// Returns the number of rows of the residual for each point.
  [[nodiscard]] Index rows() const { return twists() ? 4 : 3; }
  /// Returns the number of independent residuals per point, since the residual along the rod is not
  /// independent. It is also the number of strains of an arc.
  [[nodiscard]] Index numbers() const { return planar ? 1 : rows() - 1; }

  /// Returns the number of components of rotation and position that a fit changes.
  [[nodiscard]] Index pose_parameters() const { return planar ? 3 : 6; }
  /// Returns the number of parameters of a number of arcs and of their pose.
  [[nodiscard]] Index parameters(Index arcs) const { return pose_parameters() + numbers() * arcs; }

  /// Whether a point's arc length is unknown and follows from the nearest point of the arcs.
  [[nodiscard]] bool has_free_arc_length(Index i) const {
    return !has_arc_lengths && i > 0 && i + 1 < points.cols();
  }
};

/// Returns position and frame at arc length `s` from the begin of an arc of constant strain.
/// @param s  negative before the begin
ArcPlace along_arc(const ArcPlace& begin, const Vector3d& strain, double s) {
  const double rate = strain.norm();
  const double angle = rate * s;
  if (!(std::abs(angle) > 1e-12)) {
    return {begin.point + s * begin.frame.col(2), begin.frame};
  }
  // The tangent rotates about the axis: its component along the axis stays, and t' = u2 d1 - u1 d2.
  const Vector3d axis = strain / rate;
  const Vector3d along = axis.z() * axis;
  const Vector3d inward(axis.y(), -axis.x(), 0);
  const Vector3d step(inward * (2 * std::pow(std::sin(angle / 2), 2) / rate) +
                      (Vector3d::UnitZ() - along) * (std::sin(angle) / rate) + s * along);
  return {begin.point + begin.frame * step,
          begin.frame * Eigen::AngleAxisd(angle, axis).toRotationMatrix()};
}

/// Returns positions and frames of arcs of equal length at arc lengths.
std::vector<ArcPlace> evaluate_arcs(const RestShape& shape, const std::vector<double>& s) {
  const double h = shape.arcs.front().end;
  std::vector<ArcPlace> begins = {{shape.begin, shape.first_frame}};
  for (const RestShape::Arc& arc : shape.arcs) {
    begins.push_back(along_arc(begins.back(), arc.strain, h));
  }
  std::vector<ArcPlace> result;
  result.reserve(s.size());
  for (const double at : s) {
    const auto k = std::min(static_cast<std::size_t>(at / h), shape.arcs.size() - 1);
    result.push_back(along_arc(begins[k], shape.arcs[k].strain, at - static_cast<double>(k) * h));
  }
  return result;
}

/// Returns the residual: the vectors from the points to the arcs, divided by the length, three rows
/// per point; with frames a fourth row, the angle of d1 times angle_weight. A vector of a point
/// that has_free_arc_length() has no component along the arc.
Eigen::VectorXd arc_residual(const ArcTarget& target, const RestShape& arcs) {
  const std::vector<ArcPlace> places = evaluate_arcs(arcs, target.s);
  const Index rows = target.rows();
  Eigen::VectorXd r(rows * target.points.cols());
  for (Index i = 0; i < target.points.cols(); ++i) {
    const ArcPlace& at = places[static_cast<std::size_t>(i)];
    const Vector3d t = at.frame.col(2);
    Vector3d d = at.point - target.points.col(i);
    if (target.has_free_arc_length(i)) d -= d.dot(t) * t;
    r.segment<3>(rows * i) = d / target.length;
    if (!target.twists()) continue;
    const Vector3d given = target.d1.col(i);
    r[rows * i + 3] =
        angle_weight * std::atan2(-given.dot(at.frame.col(1)), given.dot(at.frame.col(0)));
  }
  return r;
}

/// Moves unknown arc lengths towards those of the nearest points of the arcs, along the tangents.
void update_arc_lengths(ArcTarget& target, const RestShape& arcs) {
  const std::vector<ArcPlace> places = evaluate_arcs(arcs, target.s);
  for (Index i = 0; i < target.points.cols(); ++i) {
    if (!target.has_free_arc_length(i)) continue;
    const auto [point, frame] = places[static_cast<std::size_t>(i)];
    double& s = target.s[static_cast<std::size_t>(i)];
    s = std::clamp(s + frame.col(2).dot(target.points.col(i) - point), 0.0, target.length);
  }
}

/// Returns the arcs with all their parameters changed. Rotations, and strains times length, are in
/// radians; positions are divided by the length.
RestShape changed_arcs(const ArcTarget& target, RestShape arcs, const Eigen::VectorXd& change) {
  Vector3d turn = target.normal;
  Vector3d shift;
  if (target.planar) {
    turn *= change[0];
    shift = change[1] * arcs.first_frame.col(0) + change[2] * arcs.first_frame.col(2);
  } else {
    turn = change.head<3>();
    shift = change.segment<3>(3);
  }
  arcs.first_frame = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()) * arcs.first_frame;
  arcs.begin += target.length * shift;
  const Index first = target.planar ? 1 : 0;
  for (Index k = target.pose_parameters(); RestShape::Arc & arc : arcs.arcs) {
    arc.strain.segment(first, target.numbers()) +=
        change.segment(k, target.numbers()) / target.length;
    k += target.numbers();
  }
  return arcs;
}

/// Arcs that GSL changes to fit a target. Its parameters are 1 plus the changes, because its
/// differences are relative to the parameters.
struct ArcFit {
  const ArcTarget& target;
  const RestShape& guess;

  [[nodiscard]] RestShape arcs(const gsl_vector* x) const {
    const Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>> parameters(
        x->data, static_cast<Index>(x->size), Eigen::InnerStride<>(static_cast<Index>(x->stride)));
    return changed_arcs(target, guess, parameters.array() - 1);
  }

  static int residual(const gsl_vector* x, void* fit, gsl_vector* f) {
    const auto& [target, guess] = *static_cast<const ArcFit*>(fit);
    const Eigen::VectorXd r = arc_residual(target, ArcFit{target, guess}.arcs(x));
    for (Index i = 0; i < r.size(); ++i) gsl_vector_set(f, static_cast<std::size_t>(i), r[i]);
    return GSL_SUCCESS;
  }
};

/// Fits arcs by nonlinear least squares; if arc lengths are unknown, fits these too, three times in
/// alternation. @return the sum of squared residuals of arc_residual()
double minimise_arc_residual(ArcTarget& target, RestShape& arcs) {
  silence_gsl();
  const auto n = static_cast<std::size_t>(target.rows() * target.points.cols());
  const auto p = static_cast<std::size_t>(target.parameters(std::ssize(arcs.arcs)));
  const gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  const auto workspace =
      gsl_owned(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n, p),
                gsl_multifit_nlinear_free);
  const auto start = gsl_owned(gsl_vector_alloc(p), gsl_vector_free);
  gsl_vector_set_all(start.get(), 1);
  for (int round = 0; round < (target.has_arc_lengths ? 1 : 3); ++round) {
    const RestShape guess = arcs;
    ArcFit fit{target, guess};
    gsl_multifit_nlinear_fdf function{};
    function.f = ArcFit::residual;
    function.n = n;
    function.p = p;
    function.params = &fit;
    int reason = 0;
    // A fit that stops early has a larger error, which is stated.
    if (gsl_multifit_nlinear_init(start.get(), &function, workspace.get()) != GSL_SUCCESS) break;
    (void)gsl_multifit_nlinear_driver(30, 1e-10, 0, 0, nullptr, nullptr, &reason, workspace.get());
    arcs = fit.arcs(gsl_multifit_nlinear_position(workspace.get()));
    update_arc_lengths(target, arcs);
  }
  return arc_residual(target, arcs).squaredNorm();
}

/// Strains at the inner points of a polyline, in frames from given directors or else in frames
/// transported along the polyline.
struct Profile {
  Eigen::Matrix3Xd strain;
  std::vector<double> segments;  // lengths of arcs over the chords [m]
  Matrix3d first_frame;          // frame on the first chord
};

Matrix3d frame_on(const Vector3d& tangent, const Vector3d& normal) {
  Matrix3d frame;
  const Vector3d d2 = (normal - normal.dot(tangent) * tangent).normalized();
  frame << d2.cross(tangent), d2, tangent;
  return frame;
}

Profile profile_of(const ArcTarget& target) {
  const Eigen::Matrix3Xd& points = target.points;
  const Index joints = points.cols() - 2;
  Profile profile;
  profile.strain.resize(3, joints);
  const auto chord = [&](Index i) -> Vector3d { return points.col(i + 1) - points.col(i); };
  const auto frame_at = [&](Index i, const Vector3d& transported) {
    const Vector3d t = chord(i).normalized();
    return frame_on(t, target.twists() ? Vector3d(t.cross(target.d1.col(i) + target.d1.col(i + 1)))
                                       : transported);
  };
  Matrix3d frame = frame_at(0, target.normal);
  profile.first_frame = frame;
  for (Index j = 0; j < joints; ++j) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(frame.col(2), chord(j + 1));
    const Matrix3d next = frame_at(j + 1, turn * frame.col(1));
    const Eigen::AngleAxisd rotation(frame.transpose() * next);
    const double across = (chord(j).norm() + chord(j + 1).norm()) / 2;
    profile.strain.col(j) = rotation.angle() / across * rotation.axis();
    frame = next;
  }
  for (Index i = 0; i <= joints; ++i) {
    const double before = profile.strain.col(std::max<Index>(i - 1, 0)).head<2>().norm();
    const double after = profile.strain.col(std::min(i, joints - 1)).head<2>().norm();
    const double half = std::min((before + after) / 4 * chord(i).norm(), 1.5);
    profile.segments.push_back(chord(i).norm() * (half > 1e-8 ? half / std::sin(half) : 1));
  }
  return profile;
}

/// Returns arcs of equal length with the mean strains of the profile.
RestShape first_guess(const ArcTarget& target, const Profile& profile, int count) {
  RestShape guess;
  const auto first_joint_after = [&](double s) {  // joint j is at point j + 1
    return std::lower_bound(target.s.begin() + 1, target.s.end() - 1, s) - target.s.begin() - 1;
  };
  for (int k = 0; k < count; ++k) {
    const double end = (k + 1) * target.length / count;
    const Index joint = first_joint_after(k * target.length / count);
    const Index joints = std::max<Index>(first_joint_after(end) - joint, 1);
    RestShape::Arc arc{end,
                       profile.strain.middleCols(std::min(joint, profile.strain.cols() - 1), joints)
                           .rowwise()
                           .mean()};
    if (target.planar) arc.strain.x() = 0;
    if (!target.twists()) arc.strain.z() = 0;
    guess.arcs.push_back(arc);
  }
  guess.arcs.back().end = target.length;
  guess.begin = target.points.col(0);
  // The first chord has the direction of the arc's tangent in the middle of the chord.
  guess.first_frame =
      along_arc({guess.begin, profile.first_frame}, guess.arcs.front().strain, -target.s[1] / 2)
          .frame;
  return guess;
}

/// Sets `normal` and `planar` of a target from its points and d1.
void find_points_plane(ArcTarget& target) {
  const Vector3d centre = target.points.rowwise().mean();
  const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(target.points.colwise() - centre,
                                               Eigen::ComputeFullU);
  const Matrix3d& axes = svd.matrixU();
  const auto spread = [&](Index k) {
    return (axes.col(k).transpose() * (target.points.colwise() - centre)).cwiseAbs().maxCoeff();
  };
  const double noise = plane_share * target.length;
  target.planar = spread(2) <= noise;
  const Vector3d first = (target.points.col(1) - target.points.col(0)).normalized();
  Vector3d normal = axes.col(2);
  if (spread(1) <= noise) {
    // A straight line has no normal of its own: the plane also contains the x axis, or else has the
    // normal z.
    const Vector3d across = first.cross(Vector3d::UnitX());
    normal = across.norm() > 1e-6 ? across.normalized() : Vector3d(Vector3d::UnitZ());
  } else if (first.cross(normal).norm() < 0.1) {
    normal = axes.col(1);
  }
  for (const Index axis : {2, 1, 0}) {
    constexpr double rounding = 1e-9;
    if (std::abs(normal[axis]) <= rounding) continue;
    if (normal[axis] < 0) normal = -normal;
    break;
  }
  // A normal within rounding of an axis is set to the axis exactly.
  for (const Index axis : {2, 1, 0}) {
    if ((normal - Vector3d::Unit(axis)).norm() < plane_share) normal = Vector3d::Unit(axis);
  }
  target.normal = normal;
  if (target.d1.cols() == 0) return;
  const Vector3d side = first.cross(target.d1.col(0));
  if (side.dot(normal) < 0) target.normal = -normal;
  target.planar =
      target.planar && (normal.transpose() * target.d1).cwiseAbs().maxCoeff() <= plane_share;
}

void require_small_turns(const ArcTarget& target, const std::string& file) {
  for (Index i = 1; i < target.d1.cols(); ++i) {
    if (target.d1.col(i).dot(target.d1.col(i - 1)) > 0) continue;
    throw InputError(
        fmt::format("{}: d1 rotates by a right angle or more to point {} of the {} that are fitted "
                    "(allowed: less between neighbours)",
                    file, i + 1, target.d1.cols()));
  }
}

MeasuredShape with_increasing_arc_length(const MeasuredShape& points) {
  const std::vector<double>& s = points.arc_length;
  if (s.empty() || s.back() > s.front()) return points;
  return {points.file, points.points.rowwise().reverse(), std::vector<double>(s.rbegin(), s.rend()),
          points.d1.rowwise().reverse()};
}

/// Returns the arc lengths of all points from those of the points `chosen`, `s`; between two chosen
/// points they are equally spaced.
std::vector<double> all_arc_lengths(const std::vector<Index>& chosen,
                                    const std::vector<double>& s) {
  std::vector<double> all = {0};
  for (std::size_t k = 0; k + 1 < chosen.size(); ++k) {
    const auto count = static_cast<double>(chosen[k + 1] - chosen[k]);
    for (double i = 1; i <= count; ++i) all.push_back(std::lerp(s[k], s[k + 1], i / count));
  }
  return all;
}

/// Computes the errors of a rest shape over all measured points, not only the fitted ones.
void set_rest_shape_errors(ArcTarget all, RestShape& shape) {
  constexpr int projection_rounds = 5;
  for (int i = 0; i < projection_rounds; ++i) update_arc_lengths(all, shape);
  const std::vector<ArcPlace> places = evaluate_arcs(shape, all.s);
  double sum = 0;
  for (Index i = 0; i < all.points.cols(); ++i) {
    const ArcPlace& at = places[static_cast<std::size_t>(i)];
    const double d = (at.point - all.points.col(i)).norm();
    shape.largest_error = std::max(shape.largest_error, d);
    sum += d * d;
    if (all.d1.cols() == 0) continue;
    const Vector3d given = all.d1.col(i);
    const Vector3d d1 = at.frame.col(0);
    shape.largest_angle = std::max(shape.largest_angle.value_or(0),
                                   std::atan2(d1.cross(given).norm(), d1.dot(given)));
  }
  shape.rms_error = std::sqrt(sum / static_cast<double>(all.points.cols()));
}

/// Returns Schwarz's criterion (BIC) divided by the number of residuals. A constant of the size of
/// rounding keeps the logarithm finite.
double schwarz_criterion(const ArcTarget& target, int arcs, double sum) {
  const auto n = static_cast<double>(target.points.cols() * target.numbers());
  constexpr double rounding = 1e-20;
  const auto p = static_cast<double>(target.parameters(arcs));
  return std::log(sum / n + rounding) + p * std::log(n) / n;
}

std::vector<Index> evenly_spread_indices(Index count, Index chosen) {
  std::vector<Index> result;
  result.reserve(static_cast<std::size_t>(chosen));
  for (Index k = 0; k < chosen; ++k) result.push_back(k * (count - 1) / (chosen - 1));
  return result;
}

/// Sets the arc lengths of the target's points, scaled to the rod's length.
/// @return the length of the curve itself [m]
/// @throws InputError if it differs from the rod's by more than length_tolerance
double set_target_arc_lengths(const MeasuredShape& given, const std::vector<Index>& chosen,
                              const Profile& profile, ArcTarget& target) {
  double curve = 0;
  target.s = {0};
  for (const double segment : profile.segments) target.s.push_back(curve += segment);
  if (!given.arc_length.empty()) {
    target.has_arc_lengths = true;
    curve = given.arc_length.back() - given.arc_length.front();
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      target.s[k] = given.arc_length[static_cast<std::size_t>(chosen[k])] - given.arc_length[0];
    }
  }
  if (!(std::abs(curve / target.length - 1) <= length_tolerance)) {
    throw InputError(
        fmt::format("{}: a curve {:.6g} m long, but the rod is {:.6g} m long (allowed: equal "
                    "within {:g} %, the curve is then scaled)",
                    given.file, curve, target.length, 100 * length_tolerance));
  }
  for (double& s : target.s) s *= target.length / curve;
  target.s.back() = target.length;
  return curve;
}

/// Fitted arcs, and the target with the arc lengths found for them.
struct FittedArcs {
  ArcTarget target;
  RestShape arcs;
};

/// Returns the fit with the number of arcs that Schwarz's criterion selects.
FittedArcs best_arcs(const ArcTarget& target, const Profile& profile) {
  FittedArcs best;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (const int arcs : {1, 2, 3, 4, 6, 8, 12, 16, 24, most_rest_arcs}) {
    if (arcs > 1 && 2 * target.parameters(arcs) > target.points.cols() * target.numbers()) break;
    FittedArcs fit{target, first_guess(target, profile, arcs)};
    const double sum = minimise_arc_residual(fit.target, fit.arcs);
    const double value = schwarz_criterion(target, arcs, sum);
    worse = value < least ? 0 : worse + 1;
    if (value < least) {
      least = value;
      best = std::move(fit);
    }
    constexpr int most_worse = 3;
    if (worse == most_worse || sum <= std::pow(sufficient_accuracy, 2)) break;
  }
  return best;
}

}  // namespace

RestShape fit_rest_shape(const MeasuredShape& measured, double length) {
  const MeasuredShape given = with_increasing_arc_length(measured);
  const Index count = given.points.cols();
  constexpr Index least_count = 5;
  if (count < least_count) {
    throw InputError(fmt::format("{}: {} points (allowed: {} or more of a rest shape)", given.file,
                                 count, least_count));
  }
  const std::vector<Index> chosen =
      evenly_spread_indices(count, std::min(count, most_fitted_points));
  ArcTarget target;
  target.length = length;
  target.points = given.points(Eigen::all, chosen);
  if (given.d1.cols() > 0) target.d1 = given.d1(Eigen::all, chosen);
  require_small_turns(target, given.file);
  find_points_plane(target);
  const Profile profile = profile_of(target);
  const double curve = set_target_arc_lengths(given, chosen, profile, target);
  const FittedArcs best = best_arcs(target, profile);

  RestShape shape = best.arcs;
  shape.file = given.file;
  shape.points = count;
  ArcTarget all = best.target;
  all.points = given.points;
  all.d1 = given.d1;
  all.s = all_arc_lengths(chosen, best.target.s);
  if (target.has_arc_lengths) {
    for (std::size_t i = 0; i < all.s.size(); ++i) {
      all.s[i] = (given.arc_length[i] - given.arc_length[0]) * length / curve;
    }
  }
  set_rest_shape_errors(all, shape);
  return shape;
}

Eigen::Vector3d helix_strain(double radius, double pitch) {
  const double rise = pitch / (2 * std::numbers::pi);
  const double square = radius * radius + rise * rise;
  return {0, radius / square, rise / square};
}

}  // namespace dlo::compare
