#include "dlo/compare/rest_shape.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A fit looks at so many points: more would cost time in proportion and say little more about
/// arcs.
constexpr Index most_fitted_points = 150;
/// Out of a plane by less [l], points are in it.
constexpr double plane_share = 1e-6;
/// Once no point is farther away [l], no more arcs are tried.
constexpr double good_enough_share = 1e-7;
/// The points' curve may be longer or shorter than the rod by this share.
constexpr double length_tolerance = 0.05;

/// Where a rod that has the strains of an arc is behind its begin, and its frame there.
struct ArcPlace {
  Vector3d point;
  Matrix3d frame;  // d1, d2, t
};

ArcPlace along_arc(const ArcPlace& begin, const Vector2d& curvature, double s) {
  const double rate = curvature.norm();
  const double angle = rate * s;
  if (!(std::abs(angle) > 1e-12)) {
    return {begin.point + s * begin.frame.col(2), begin.frame};
  }
  const Vector3d axis(curvature.x() / rate, curvature.y() / rate, 0);
  // t' = u2 d1 - u1 d2
  const Vector3d inward(axis.y(), -axis.x(), 0);
  const Vector3d step(inward * (2 * std::pow(std::sin(angle / 2), 2) / rate) +
                      Vector3d::UnitZ() * (std::sin(angle) / rate));
  return {begin.point + begin.frame * step,
          begin.frame * Eigen::AngleAxisd(angle, axis).toRotationMatrix()};
}

/// Arcs and where they are.
struct Arcs {
  ArcPlace begin;
  std::vector<RestShape::Arc> arcs;
};

/// Points of arcs at many arc lengths.
class Trace {
 public:
  explicit Trace(const Arcs& arcs) : arcs_(arcs.arcs) {
    ArcPlace at = arcs.begin;
    double before = 0;
    for (const RestShape::Arc& arc : arcs_) {
      begins_.push_back({before, at});
      at = along_arc(at, arc.curvature, arc.end - before);
      before = arc.end;
    }
  }
  [[nodiscard]] ArcPlace at(double s) const {
    const auto after = std::find_if(arcs_.begin(), std::prev(arcs_.end()),
                                    [s](const RestShape::Arc& arc) { return s < arc.end; });
    const Begin& begin = begins_[static_cast<std::size_t>(after - arcs_.begin())];
    return along_arc(begin.placed, after->curvature, s - begin.s);
  }

 private:
  struct Begin {
    double s;
    ArcPlace placed;
  };
  const std::vector<RestShape::Arc>& arcs_;
  std::vector<Begin> begins_;
};

/// Points to fit, and what is known of their arc lengths.
struct Target {
  Eigen::Matrix3Xd points;
  std::vector<double> s;
  bool knows_s = false;  // else that of inner points is that of the nearest point
  double length = 0;
  bool planar = false;
  Vector3d normal;

  [[nodiscard]] bool slides(Index i) const { return !knows_s && i > 0 && i + 1 < points.cols(); }
};

Vector3d arc_difference(const Target& target, Index i, const ArcPlace& at) {
  const Vector3d d = at.point - target.points.col(i);
  const Vector3d t = at.frame.col(2);
  return target.slides(i) ? Vector3d(d - d.dot(t) * t) : d;
}

Eigen::VectorXd arc_residual(const Target& target, const Arcs& arcs) {
  const Trace trace(arcs);
  Eigen::VectorXd r(3 * target.points.cols());
  for (Index i = 0; i < target.points.cols(); ++i) {
    r.segment<3>(3 * i) =
        arc_difference(target, i, trace.at(target.s[static_cast<std::size_t>(i)])) / target.length;
  }
  return r;
}

/// Moves the arc lengths that are not known to those of the nearest points.
void slide_along(Target& target, const Arcs& arcs) {
  const Trace trace(arcs);
  for (Index i = 0; i < target.points.cols(); ++i) {
    if (!target.slides(i)) continue;
    double& s = target.s[static_cast<std::size_t>(i)];
    const ArcPlace at = trace.at(s);
    s = std::clamp(s + at.frame.col(2).dot(target.points.col(i) - at.point), 0.0, target.length);
  }
}

/// Arcs a step of all their parameters away: rotation, position, curvatures, ends, over the length.
Arcs stepped_arcs(const Target& target, Arcs arcs, const Eigen::VectorXd& step) {
  Index k = 0;
  const double l = target.length;
  ArcPlace& begin = arcs.begin;
  if (target.planar) {
    begin.frame = Eigen::AngleAxisd(step[k], target.normal) * begin.frame;
    const Vector3d across = begin.frame.col(0);
    begin.point += l * (step[k + 1] * across + step[k + 2] * begin.frame.col(2));
    k += 3;
  } else {
    const Vector3d turn = step.segment<3>(k);
    if (turn.norm() > 0) {
      begin.frame = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * begin.frame;
    }
    begin.point += l * step.segment<3>(k + 3);
    k += 6;
  }
  for (RestShape::Arc& arc : arcs.arcs) {
    if (!target.planar) arc.curvature.x() += step[k++] / l;
    arc.curvature.y() += step[k++] / l;
  }
  for (std::size_t i = 0; i + 1 < arcs.arcs.size(); ++i) arcs.arcs[i].end += l * step[k++];
  return arcs;
}

Index arc_parameters(const Target& target, std::size_t arcs) {
  const auto n = static_cast<Index>(arcs);
  return (target.planar ? 3 + n : 6 + 2 * n) + n - 1;
}

/// Of the residual by all parameters, but for what slides: differences of the arc that a parameter
/// belongs to, behind which the others move as a rigid body.
Eigen::MatrixXd arc_derivative(const Target& target, const Arcs& arcs) {
  constexpr double h = 1e-7;  // of a parameter over its unit
  const Index count = arc_parameters(target, arcs.arcs.size());
  const std::size_t n = arcs.arcs.size();
  std::vector<ArcPlace> begins = {arcs.begin};
  std::vector<double> bounds(1, 0.0);
  for (const RestShape::Arc& arc : arcs.arcs) {
    begins.push_back(along_arc(begins.back(), arc.curvature, arc.end - bounds.back()));
    bounds.push_back(arc.end);
  }
  const Trace trace(arcs);
  std::vector<ArcPlace> at;
  std::vector<std::size_t> on;  // the arc of each point
  for (const double s : target.s) {
    at.push_back(trace.at(s));
    const auto after = std::upper_bound(bounds.begin() + 1, bounds.end() - 1, s);
    on.push_back(static_cast<std::size_t>(after - bounds.begin()) - 1);
  }
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * target.points.cols(), count);
  Index column = 0;
  const auto set = [&](Index i, const Eigen::Vector3d& moved) {
    const Vector3d t = at[static_cast<std::size_t>(i)].frame.col(2);
    J.col(column).segment<3>(3 * i) =
        (target.slides(i) ? Vector3d(moved - moved.dot(t) * t) : moved) / target.length;
  };
  // Points of arcs from `first` on, of which those up to `last` are bent and the others rigid.
  const auto move = [&](const Arcs& next, std::size_t first, std::size_t last) {
    std::vector<ArcPlace> moved = begins;
    if (first == 0) moved[0] = next.begin;
    for (std::size_t k = first; k <= last; ++k) {
      const double from = k == 0 ? 0 : next.arcs[k - 1].end;
      moved[k + 1] = along_arc(moved[k], next.arcs[k].curvature, next.arcs[k].end - from);
    }
    const ArcPlace& end = moved[last + 1];
    const Matrix3d turn = end.frame * begins[last + 1].frame.transpose();
    for (Index i = 0; i < target.points.cols(); ++i) {
      const auto point = static_cast<std::size_t>(i);
      const std::size_t k = on[point];
      if (k < first) continue;
      const double from = k == 0 ? 0 : next.arcs[k - 1].end;
      const Vector3d there =
          k <= last ? along_arc(moved[k], next.arcs[k].curvature, target.s[point] - from).point
                    : Vector3d(end.point + turn * (at[point].point - begins[last + 1].point));
      set(i, (there - at[point].point) / h);
    }
  };
  const auto next = [&] {
    return stepped_arcs(target, arcs, h * Eigen::VectorXd::Unit(count, column));
  };
  const Index pose = target.planar ? 3 : 6;
  for (; column < pose; ++column) {
    const Arcs moved = next();
    const Matrix3d turn = moved.begin.frame * arcs.begin.frame.transpose();
    for (Index i = 0; i < target.points.cols(); ++i) {
      const Vector3d& point = at[static_cast<std::size_t>(i)].point;
      set(i, (moved.begin.point + turn * (point - arcs.begin.point) - point) / h);
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (int axis = target.planar ? 1 : 0; axis < 2; ++axis, ++column) move(next(), k, k);
  }
  for (std::size_t k = 0; k + 1 < n; ++k, ++column) move(next(), k, k + 1);
  return J;
}

bool in_order(const Target& target, const Arcs& arcs) {
  double before = 0;
  const double least = 1e-4 * target.length;
  return std::all_of(arcs.arcs.begin(), arcs.arcs.end(), [&](const RestShape::Arc& arc) {
    const bool grows = arc.end - before >= least;
    before = arc.end;
    return grows;
  });
}

/// When an iteration ends.
struct Effort {
  int most_steps;
  double least_gain;  // of the sum of squares in a step, a share of it
};
constexpr Effort of_candidate{10, 3e-2};
constexpr Effort of_result{30, 1e-6};

/// Levenberg and Marquardt's method; arc lengths that are not known follow. Returns the sum of
/// squares over the length's.
double improve_arcs(Target& target, Arcs& arcs, const Effort& effort) {
  double damping = 1e-3;
  Eigen::VectorXd r = arc_residual(target, arcs);
  for (int step = 0; step < effort.most_steps; ++step) {
    const Eigen::MatrixXd J = arc_derivative(target, arcs);
    const Eigen::MatrixXd H = J.transpose() * J;
    const Eigen::VectorXd g = J.transpose() * r;
    const double before = r.squaredNorm();
    bool better = false;
    for (int tries = 0; tries < 8 && !better; ++tries) {
      Eigen::MatrixXd damped = H;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += 1e-14 * H.diagonal().maxCoeff();
      const Arcs next = stepped_arcs(target, arcs, damped.ldlt().solve(-g));
      if (in_order(target, next)) {
        Target there = target;
        slide_along(there, next);
        const Eigen::VectorXd after = arc_residual(there, next);
        if (after.squaredNorm() < before) {
          arcs = next;
          target = there;
          r = after;
          better = true;
        }
      }
      damping = better ? std::max(damping / 10, 1e-12) : 8 * damping;
    }
    if (!better || r.squaredNorm() > (1 - effort.least_gain) * before) break;
  }
  return r.squaredNorm();
}

/// Curvature at the inner points of a polyline about directors that are transported along it.
struct Profile {
  Eigen::Matrix2Xd curvature;
  std::vector<double> segments;  // lengths of arcs over the chords
};

Matrix3d frame_on(const Vector3d& tangent, const Vector3d& normal) {
  Matrix3d frame;
  const Vector3d d2 = (normal - normal.dot(tangent) * tangent).normalized();
  frame << d2.cross(tangent), d2, tangent;
  return frame;
}

Profile profile_of(const Eigen::Matrix3Xd& points, const Vector3d& normal) {
  const Index joints = points.cols() - 2;
  Profile profile;
  profile.curvature.resize(2, joints);
  const auto chord = [&](Index i) -> Vector3d { return points.col(i + 1) - points.col(i); };
  Matrix3d frame = frame_on(chord(0).normalized(), normal);
  for (Index j = 0; j < joints; ++j) {
    const Vector3d next = chord(j + 1);
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(frame.col(2), next);
    const Eigen::AngleAxisd rotation(turn);
    const Vector3d bend = rotation.angle() * rotation.axis();
    const double across = (chord(j).norm() + next.norm()) / 2;
    profile.curvature.col(j) = Vector2d(bend.dot(frame.col(0)), bend.dot(frame.col(1))) / across;
    frame = rotation * frame;
    frame = frame_on(next.normalized(), frame.col(1));
  }
  for (Index i = 0; i <= joints; ++i) {
    const double before = profile.curvature.col(std::max<Index>(i - 1, 0)).norm();
    const double after = profile.curvature.col(std::min(i, joints - 1)).norm();
    const double half = std::min((before + after) / 4 * chord(i).norm(), 1.5);
    profile.segments.push_back(chord(i).norm() * (half > 1e-8 ? half / std::sin(half) : 1));
  }
  return profile;
}

/// Places to cut a profile into pieces of one curvature, that first which lowers the sum of squares
/// most.
std::vector<Index> cuts_of(const Eigen::Matrix2Xd& curvature, std::size_t most) {
  const Index n = curvature.cols();
  Eigen::Matrix2Xd sums = Eigen::Matrix2Xd::Zero(2, n + 1);
  for (Index j = 0; j < n; ++j) sums.col(j + 1) = sums.col(j) + curvature.col(j);
  // What is explained by the mean of a piece.
  const auto explained = [&](Index a, Index b) {
    return (sums.col(b) - sums.col(a)).squaredNorm() / static_cast<double>(b - a);
  };
  std::vector<Index> cuts;
  std::vector<Index> bounds = {0, n};
  while (cuts.size() < most) {
    double most_gain = -1;
    Index best = 0;
    for (std::size_t p = 0; p + 1 < bounds.size(); ++p) {
      const Index a = bounds[p];
      const Index b = bounds[p + 1];
      for (Index c = a + 1; c < b; ++c) {
        const double gain = explained(a, c) + explained(c, b) - explained(a, b);
        if (gain > most_gain) {
          most_gain = gain;
          best = c;
        }
      }
    }
    if (best == 0) break;
    cuts.push_back(best);
    bounds.insert(std::upper_bound(bounds.begin(), bounds.end(), best), best);
  }
  return cuts;
}

Arcs first_guess(const Target& target, const Profile& profile, std::vector<Index> cuts) {
  std::sort(cuts.begin(), cuts.end());
  cuts.push_back(profile.curvature.cols());
  Arcs guess;
  Index before = 0;
  for (const Index cut : cuts) {
    RestShape::Arc arc;
    arc.curvature = profile.curvature.middleCols(before, cut - before).rowwise().mean();
    if (target.planar) arc.curvature.x() = 0;
    // Joint j is at point j + 1.
    const auto i = static_cast<std::size_t>(cut);
    arc.end = cut == cuts.back() ? target.length : (target.s[i] + target.s[i + 1]) / 2;
    guess.arcs.push_back(arc);
    before = cut;
  }
  const Vector3d first_chord = target.points.col(1) - target.points.col(0);
  guess.begin = {target.points.col(0), frame_on(first_chord.normalized(), target.normal)};
  // A chord has the direction of its arc's middle.
  guess.begin = {guess.begin.point,
                 along_arc(guess.begin, guess.arcs.front().curvature, -target.s[1] / 2).frame};
  return guess;
}

/// The same arcs, some cut in their middle so that there are more: those that leave most.
Arcs cut_where_far(const Target& target, const Arcs& arcs, std::size_t count) {
  struct Piece {
    RestShape::Arc arc;
    double begin, left;
  };
  std::vector<Piece> pieces;
  double before = 0;
  for (const RestShape::Arc& arc : arcs.arcs) {
    pieces.push_back({arc, before, 0});
    before = arc.end;
  }
  const Eigen::VectorXd r = arc_residual(target, arcs);
  for (Index i = 0; i < target.points.cols(); ++i) {
    const double s = target.s[static_cast<std::size_t>(i)];
    const auto on = std::find_if(pieces.begin(), std::prev(pieces.end()),
                                 [s](const Piece& piece) { return s < piece.arc.end; });
    on->left += r.segment<3>(3 * i).squaredNorm();
  }
  while (pieces.size() < count) {
    const auto most =
        std::max_element(pieces.begin(), pieces.end(),
                         [](const Piece& a, const Piece& b) { return a.left < b.left; });
    // An arc's distance from a curve grows with the third power of its length.
    constexpr double of_half = 1.0 / 64 / 2;
    most->left *= of_half;
    Piece first = *most;
    first.arc.end = (first.begin + first.arc.end) / 2;
    most->begin = first.arc.end;
    pieces.insert(most, first);
  }
  Arcs cut{arcs.begin, {}};
  for (const Piece& piece : pieces) cut.arcs.push_back(piece.arc);
  return cut;
}

/// Sets normal and planar.
void find_points_plane(Target& target) {
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
    // A line is in the plane that holds x, or y.
    const Vector3d beside = first.cross(Vector3d::UnitX());
    normal = beside.norm() > 1e-6 ? beside.normalized() : Vector3d(Vector3d::UnitZ());
  } else if (first.cross(normal).norm() < 0.1) {
    normal = axes.col(1);
  }
  for (const Index axis : {2, 1, 0}) {
    constexpr double rounding = 1e-9;
    if (std::abs(normal[axis]) <= rounding) continue;
    if (normal[axis] < 0) normal = -normal;
    break;
  }
  // Of the axes' own planes exactly.
  for (const Index axis : {2, 1, 0}) {
    if ((normal - Vector3d::Unit(axis)).norm() < plane_share) normal = Vector3d::Unit(axis);
  }
  target.normal = normal;
}

MeasuredShape forwards(const MeasuredShape& points) {
  const std::vector<double>& s = points.arc_length;
  if (s.empty() || s.back() > s.front()) return points;
  return {points.file, points.points.rowwise().reverse(),
          std::vector<double>(s.rbegin(), s.rend())};
}

/// Arc lengths of all points, scaled to the rod's, of which `chosen` are known.
std::vector<double> all_arc_lengths(const Eigen::Matrix3Xd& points,
                                    const std::vector<Index>& chosen,
                                    const std::vector<double>& s) {
  std::vector<double> all = {0};
  for (std::size_t k = 0; k + 1 < chosen.size(); ++k) {
    std::vector<double> along = {0};
    for (Index i = chosen[k]; i < chosen[k + 1]; ++i) {
      along.push_back(along.back() + (points.col(i + 1) - points.col(i)).norm());
    }
    for (std::size_t i = 1; i < along.size(); ++i) {
      all.push_back(s[k] + (s[k + 1] - s[k]) * along[i] / along.back());
    }
  }
  return all;
}

/// Of all points.
void state_error(Target all, const Arcs& arcs, RestShape& shape) {
  constexpr int projections = 5;
  for (int i = 0; i < projections; ++i) slide_along(all, arcs);
  const Trace trace(arcs);
  double sum = 0;
  for (Index i = 0; i < all.points.cols(); ++i) {
    const double d =
        (trace.at(all.s[static_cast<std::size_t>(i)]).point - all.points.col(i)).norm();
    shape.largest_error = std::max(shape.largest_error, d);
    sum += d * d;
  }
  shape.rms_error = std::sqrt(sum / static_cast<double>(all.points.cols()));
}

double largest_part(const Eigen::VectorXd& r) {
  double most = 0;
  for (Index i = 0; i + 2 < r.size(); i += 3) most = std::max(most, r.segment<3>(i).norm());
  return most;
}

/// Schwarz's criterion over the number of residuals; what rounding leaves counts as nothing.
double arc_information(const Target& target, std::size_t arcs, double sum) {
  const auto n = static_cast<double>(target.points.cols() * (target.planar ? 1 : 2));
  constexpr double rounding = 1e-20;
  const auto p = static_cast<double>(arc_parameters(target, arcs));
  return std::log(sum / n + rounding) + p * std::log(n) / n;
}

}  // namespace

RestShape fit_rest_shape(const MeasuredShape& measured, double length) {
  const MeasuredShape given = forwards(measured);
  const Index count = given.points.cols();
  constexpr Index fewest = 5;
  if (count < fewest) {
    throw InputError(fmt::format("{}: {} points (allowed: {} or more of a rest shape)", given.file,
                                 count, fewest));
  }
  std::vector<Index> chosen;
  const Index fitted = std::min(count, most_fitted_points);
  for (Index k = 0; k < fitted; ++k) chosen.push_back(k * (count - 1) / (fitted - 1));
  Target target;
  target.length = length;
  target.points.resize(3, fitted);
  for (Index k = 0; k < fitted; ++k) {
    target.points.col(k) = given.points.col(chosen[static_cast<std::size_t>(k)]);
  }
  find_points_plane(target);
  const Profile profile = profile_of(target.points, target.normal);
  double curve = 0;
  target.s = {0};
  for (const double segment : profile.segments) target.s.push_back(curve += segment);
  if (!given.arc_length.empty()) {
    target.knows_s = true;
    curve = given.arc_length.back() - given.arc_length.front();
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      target.s[k] = given.arc_length[static_cast<std::size_t>(chosen[k])] - given.arc_length[0];
    }
  }
  if (!(std::abs(curve / length - 1) <= length_tolerance)) {
    throw InputError(
        fmt::format("{}: a curve {:.6g} m long, the rod is {:.6g} m long (allowed: the same within "
                    "{:g} %, which is scaled away)",
                    given.file, curve, length, 100 * length_tolerance));
  }
  for (double& s : target.s) s *= length / curve;
  target.s.back() = length;
  const std::vector<double> s_before = target.s;

  const std::vector<Index> cuts = cuts_of(profile.curvature, most_rest_arcs - 1);
  Arcs best, last;
  Target best_target, last_target;
  double least = std::numeric_limits<double>::infinity();
  int worse = 0;
  for (const std::size_t arcs : {1, 2, 3, 4, 6, 8, 12, 16, 24, most_rest_arcs}) {
    const Index residuals = fitted * (target.planar ? 1 : 2);
    if (arcs > 1 && (arcs - 1 > cuts.size() || 2 * arc_parameters(target, arcs) > residuals)) break;
    // Cut at jumps of the points' curvature, which noise hides; equally; where fewer arcs are far.
    const auto end = cuts.begin() + static_cast<std::ptrdiff_t>(arcs - 1);
    std::vector<Index> equal;
    for (std::size_t k = 1; k < arcs; ++k) {
      equal.push_back(static_cast<Index>(k) * profile.curvature.cols() / static_cast<Index>(arcs));
    }
    Target own;
    Arcs guess;
    double sum = std::numeric_limits<double>::infinity();
    const auto attempt = [&](Target there, Arcs from) {
      const double left = improve_arcs(there, from, of_candidate);
      if (!(left < sum)) return;
      sum = left;
      own = std::move(there);
      guess = std::move(from);
    };
    attempt(target, first_guess(target, profile, {cuts.begin(), end}));
    if (arcs > 1) {
      attempt(target, first_guess(target, profile, equal));
      attempt(last_target, cut_where_far(last_target, last, arcs));
    }
    last = guess;
    last_target = own;
    const double value = arc_information(target, arcs, sum);
    worse = value < least ? 0 : worse + 1;
    if (value < least) {
      least = value;
      best = guess;
      best_target = own;
    }
    constexpr int enough_worse = 3;
    if (worse == enough_worse) break;
    if (largest_part(arc_residual(own, guess)) <= good_enough_share) break;
  }
  (void)improve_arcs(best_target, best, of_result);

  RestShape shape{.file = given.file,
                  .points = count,
                  .arcs = best.arcs,
                  .begin = best.begin.point,
                  .first_frame = best.begin.frame};
  Target all = best_target;
  all.points = given.points;
  all.s = all_arc_lengths(given.points, chosen, best_target.s);
  if (target.knows_s) {
    for (std::size_t i = 0; i < all.s.size(); ++i) {
      all.s[i] = (given.arc_length[i] - given.arc_length[0]) * length / curve;
    }
  }
  state_error(all, best, shape);
  return shape;
}

Eigen::Vector3d helix_strain(double radius, double pitch) {
  const double rise = pitch / (2 * std::numbers::pi);
  const double square = radius * radius + rise * rise;
  return {0, radius / square, rise / square};
}

}  // namespace dlo::compare
