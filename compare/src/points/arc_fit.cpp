#include "points/arc_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace dlo::compare {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d arc_difference(const ArcTarget& target, Index i, const ArcPlace& at) {
  const Vector3d d = at.point - target.points.col(i);
  const Vector3d t = at.frame.col(2);
  return target.slides(i) ? Vector3d(d - d.dot(t) * t) : d;
}

/// Returns the angle about the tangent from a given d1 to the d1 of a frame [rad].
double angle_of_frame(const Vector3d& given, const Matrix3d& frame) {
  return std::atan2(-given.dot(frame.col(1)), given.dot(frame.col(0)));
}

/// Returns the arcs after a step of all their parameters. Rotations and strains times length are in
/// radians; the position and the arc ends are divided by the length.
Arcs stepped_arcs(const ArcTarget& target, Arcs arcs, const Eigen::VectorXd& step) {
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
    if (!target.planar) arc.strain.x() += step[k++] / l;
    arc.strain.y() += step[k++] / l;
    if (target.twists()) arc.strain.z() += step[k++] / l;
  }
  for (std::size_t i = 0; i + 1 < arcs.arcs.size(); ++i) arcs.arcs[i].end += l * step[k++];
  return arcs;
}

/// Returns the points and frames at which arcs begin if the arcs from `first` to `last` are
/// replaced by those of `next` and the arcs before them stay unchanged.
std::vector<ArcPlace> moved_begins(std::vector<ArcPlace> begins, const Arcs& next,
                                   std::size_t first, std::size_t last) {
  if (first == 0) begins[0] = next.begin;
  for (std::size_t k = first; k <= last; ++k) {
    const double from = k == 0 ? 0 : next.arcs[k - 1].end;
    begins[k + 1] = along_arc(begins[k], next.arcs[k].strain, next.arcs[k].end - from);
  }
  return begins;
}

/// Computes the derivatives of the residual by all parameters, without residuals along the rod
/// where arc lengths are free. Differences are taken for the arc to which a parameter belongs; the
/// arcs behind it move as a rigid body.
Eigen::MatrixXd arc_derivative(const ArcTarget& target, const Arcs& arcs) {
  constexpr double h = 1e-7;  // of a parameter, divided by its unit
  const Index count = arc_parameters(target, arcs.arcs.size());
  const std::size_t n = arcs.arcs.size();
  const ArcTrace trace(arcs);
  const std::vector<ArcPlace>& begins = trace.begins();
  std::vector<ArcPlace> at;
  std::vector<std::size_t> on;  // the arc of each point
  for (const double s : target.s) {
    at.push_back(trace.at(s));
    on.push_back(trace.arc_of(s));
  }
  const Index rows = target.rows();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows * target.points.cols(), count);
  Index column = 0;
  const auto set = [&](Index i, const ArcPlace& there) {
    const auto point = static_cast<std::size_t>(i);
    const ArcPlace& here = at[point];
    const Vector3d t = here.frame.col(2);
    const Vector3d moved = (there.point - here.point) / h;
    const double slide = target.slides(i) ? moved.dot(t) : 0;
    J.col(column).segment<3>(rows * i) = (moved - slide * t) / target.length;
    if (!target.twists()) return;
    const double turned = there.frame.col(0).dot(here.frame.col(1)) / h;
    J(rows * i + 3, column) = frame_lever * (turned - slide * arcs.arcs[on[point]].strain.z());
  };
  // Moves the points of the arcs from `first` on: those up to `last` change shape, later ones move
  // as a rigid body.
  const auto move = [&](const Arcs& next, std::size_t first, std::size_t last) {
    const std::vector<ArcPlace> moved = moved_begins(begins, next, first, last);
    const ArcPlace& end = moved[last + 1];
    const Matrix3d turn = end.frame * begins[last + 1].frame.transpose();
    for (Index i = 0; i < target.points.cols(); ++i) {
      const auto point = static_cast<std::size_t>(i);
      const std::size_t k = on[point];
      if (k < first) continue;
      const double from = k == 0 ? 0 : next.arcs[k - 1].end;
      set(i, k <= last ? along_arc(moved[k], next.arcs[k].strain, target.s[point] - from)
                       : ArcPlace{end.point + turn * (at[point].point - begins[last + 1].point),
                                  turn * at[point].frame});
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
      const ArcPlace& here = at[static_cast<std::size_t>(i)];
      set(i, {moved.begin.point + turn * (here.point - arcs.begin.point), turn * here.frame});
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (Index axis = 0; axis < target.numbers(); ++axis, ++column) move(next(), k, k);
  }
  for (std::size_t k = 0; k + 1 < n; ++k, ++column) move(next(), k, k + 1);
  return J;
}

bool in_order(const ArcTarget& target, const Arcs& arcs) {
  double before = 0;
  const double least = 1e-4 * target.length;
  return std::all_of(arcs.arcs.begin(), arcs.arcs.end(), [&](const RestShape::Arc& arc) {
    const bool grows = arc.end - before >= least;
    before = arc.end;
    return grows;
  });
}

}  // namespace

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

ArcTrace::ArcTrace(const Arcs& arcs) : arcs_(arcs.arcs), begins_(1, arcs.begin) {
  double before = 0;
  begins_.reserve(arcs_.size() + 1);
  for (const RestShape::Arc& arc : arcs_) {
    begins_.push_back(along_arc(begins_.back(), arc.strain, arc.end - before));
    before = arc.end;
  }
}

std::size_t ArcTrace::arc_of(double s) const {
  const auto after = std::find_if(arcs_.begin(), std::prev(arcs_.end()),
                                  [s](const RestShape::Arc& arc) { return s < arc.end; });
  return static_cast<std::size_t>(after - arcs_.begin());
}

ArcPlace ArcTrace::at(double s) const {
  const std::size_t k = arc_of(s);
  return along_arc(begins_[k], arcs_[k].strain, s - (k > 0 ? arcs_[k - 1].end : 0.0));
}

Eigen::VectorXd arc_residual(const ArcTarget& target, const Arcs& arcs) {
  const ArcTrace trace(arcs);
  const Index rows = target.rows();
  Eigen::VectorXd r(rows * target.points.cols());
  for (Index i = 0; i < target.points.cols(); ++i) {
    const ArcPlace at = trace.at(target.s[static_cast<std::size_t>(i)]);
    r.segment<3>(rows * i) = arc_difference(target, i, at) / target.length;
    if (target.twists()) {
      r[rows * i + 3] = frame_lever * angle_of_frame(target.d1.col(i), at.frame);
    }
  }
  return r;
}

void slide_along(ArcTarget& target, const Arcs& arcs) {
  const ArcTrace trace(arcs);
  for (Index i = 0; i < target.points.cols(); ++i) {
    if (!target.slides(i)) continue;
    double& s = target.s[static_cast<std::size_t>(i)];
    const ArcPlace at = trace.at(s);
    s = std::clamp(s + at.frame.col(2).dot(target.points.col(i) - at.point), 0.0, target.length);
  }
}

Index arc_parameters(const ArcTarget& target, std::size_t arcs) {
  const auto n = static_cast<Index>(arcs);
  return (target.planar ? 3 : 6) + target.numbers() * n + n - 1;
}

double improve_arcs(ArcTarget& target, Arcs& arcs, const ArcEffort& effort) {
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
        ArcTarget there = target;
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

}  // namespace dlo::compare
