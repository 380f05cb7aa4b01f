#include "polygon/polygon_energy.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {
namespace {

/// Potential of a joint and its first two derivatives by h = sin^2(alpha/2) = |u - v|^2 / 4, with
/// the directions u and v of the segments. Unlike alpha, h is smooth for aligned segments.
struct Joint {
  double energy, first, second;
};

/// Computes k alpha^2 / 2. Its slope is 2 k f(h) with f = asin(sqrt h) / sqrt(h (1 - h)), the
/// series 1 + 2/3 h + 8/15 h^2 + .., in which each coefficient is 2n / (2n + 1) of the previous
/// one, and 2 h (1 - h) f' = 1 - (1 - 2 h) f.
Joint linear_joint(double k, double h) {
  // Below it 1 - (1 - 2 h) f loses digits, and 10 terms are exact.
  constexpr double series_limit = 0.02;
  constexpr int terms = 10;
  const double half = std::atan2(std::sqrt(h), std::sqrt(1 - h));  // alpha / 2
  const double energy = 2 * k * half * half;
  if (h > series_limit) {
    const double f = half / std::sqrt(h * (1 - h));
    return {energy, 2 * k * f, k * (1 - (1 - 2 * h) * f) / (h * (1 - h))};
  }
  double f = 1;
  double slope = 0;
  double term = 1;  // c_n h^(n - 1) within the loop
  for (int n = 1; n <= terms; ++n) {
    term *= 2.0 * n / (2 * n + 1) * (n > 1 ? h : 1.0);
    f += term * h;
    slope += n * term;
  }
  return {energy, 2 * k * f, 2 * k * slope};
}

Joint joint(JointLaw law, double stiffness, double L, double h) {
  const double rest = 1 - h;  // cos^2(alpha/2)
  if (law == JointLaw::paper) {
    const double q = std::sqrt(rest);
    const double m = h / (1 + q);  // 1 - cos(alpha/2), without cancellation
    const double scale = stiffness * L;
    return {scale * 4 * m * m * (1 - m / 3), scale * 2 * h / q, scale * (2 / q + h / (rest * q))};
  }
  const double k = stiffness / L;
  if (law == JointLaw::linear) return linear_joint(k, h);
  const bool squared = law == JointLaw::binormal;
  static const double fold = std::pow(std::sin(fold_angle / 2), 2);
  if (h <= fold && squared) {
    return {2 * k * h / rest, 2 * k / (rest * rest), 4 * k / (rest * rest * rest)};
  }
  if (h <= fold) return {-2 * k * std::log1p(-h), 2 * k / rest, 2 * k / (rest * rest)};
  const double moment = 2 * k * std::tan(fold_angle / 2) / (squared ? 1 - fold : 1.0);
  const double root = std::sqrt(h * rest);  // d alpha / d h = 1 / root
  const double alpha = 2 * std::atan2(std::sqrt(h), std::sqrt(rest));
  const double at_fold = squared ? 2 * k * fold / (1 - fold) : -2 * k * std::log1p(-fold);
  return {at_fold + moment * (alpha - fold_angle), moment / root,
          -moment * (1 - 2 * h) / (2 * root * root * root)};
}

/// The two segments at a bent joint, with derivatives of its angle.
struct Corner : SegmentPair {
  double h;
  Eigen::Vector3d by_a, by_b;  // derivatives of cos alpha = u.v by the two segments

  Corner(const Points& points, Eigen::Index i) : SegmentPair(points, i) {
    const Eigen::Vector3d turn = v - u;
    // Rounding may yield a value above that of a full fold.
    h = std::min(turn.squaredNorm() / 4, 1.0);
    by_a = (turn - turn.dot(u) * u) / a;
    by_b = -(turn - turn.dot(v) * v) / b;
  }
};

/// Contribution to the potential P of a joint by its stress-free angle alpha_0: -P(alpha_0) - C
/// (alpha - alpha_0), C = P'(alpha_0), alpha from a to b in the plane z = 0.
struct NaturalTurn {
  double couple = 0;    // C [N m]
  double constant = 0;  // P(alpha_0) - C alpha_0 [J]
};

NaturalTurn natural_turn(const PolygonProblem& problem, Eigen::Index i) {
  const double turn = problem.natural_turns[i - 1];
  const AngleJoint free = joint_by_angle(problem.law, joint_stiffness(problem, i),
                                         joint_length(problem.rest_lengths, i), turn);
  return {free.moment, free.energy - free.moment * turn};
}

/// Returns the second derivative of the angle of d = length u in the plane z = 0 by d.
Eigen::Matrix3d angle_hessian(const Eigen::Vector3d& u, double length) {
  const double xy = 2 * u.x() * u.y();
  const double difference = u.y() * u.y() - u.x() * u.x();
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  result.topLeftCorner<2, 2>() << xy, difference, difference, -xy;
  return result / (length * length);
}

Eigen::Vector3d rotated_left(const Eigen::Vector3d& u) { return {-u.y(), u.x(), 0}; }

/// Returns whether each point is held; obstacles do not act on a held point.
std::vector<bool> held_points(const PolygonProblem& problem) {
  std::vector<bool> held(static_cast<std::size_t>(problem.node_forces.cols()), false);
  for (const HeldPoint& point : problem.held) held[static_cast<std::size_t>(point.point)] = true;
  return held;
}

/// Returns the stiffness of a sample point: on segment i, or where segments i - 1 and i meet.
double sample_stiffness(const PointObstacle& obstacle, Eigen::Index i, double share) {
  const Eigen::VectorXd& own = obstacle.stiffnesses;
  if (own.size() == 0) return obstacle.stiffness / obstacle.samples;
  const Eigen::Index after = std::min(i, own.size() - 1);
  const Eigen::Index before = share > 0 ? after : std::max<Eigen::Index>(i - 1, 0);
  return (own[before] + own[after]) / (2 * obstacle.samples);
}

/// Calls action(i, share, point) for each sample point of the polygon on which an obstacle may act.
/// `share` is its position between point i and the next, from 0 to 1.
/// @param held  result of held_points()
template <typename Action>
void for_each_sample(const std::vector<bool>& held, const PointObstacle& obstacle,
                     const Points& points, const Action& action) {
  const Eigen::Index n = points.cols() - 1;
  const auto is_held = [&held](Eigen::Index i) { return held[static_cast<std::size_t>(i)]; };
  for (Eigen::Index i = 0; i <= n; ++i) {
    if (!is_held(i)) action(i, 0.0, Eigen::Vector3d(points.col(i)));
    if (i == n || (is_held(i) && is_held(i + 1))) continue;
    for (int k = 1; k < obstacle.samples; ++k) {
      const double share = static_cast<double>(k) / obstacle.samples;
      action(i, share, Eigen::Vector3d((1 - share) * points.col(i) + share * points.col(i + 1)));
    }
  }
}

void add_obstacle_hessian(const PolygonProblem& problem, const Points& points, HessianTerms which,
                          const AddBlock& add) {
  const std::vector<bool> held = held_points(problem);
  for (const PointObstacle& obstacle : problem.obstacles) {
    const auto stiffen = [&](Eigen::Index i, double share, const Eigen::Vector3d& point) {
      if (obstacle.body.clearance(point) >= 0) return;
      const double k = sample_stiffness(obstacle, i, share);
      const obstacle::Gap gap = obstacle.body.gap(point);
      Eigen::Matrix3d H = k * gap.gradient * gap.gradient.transpose();
      if (which == HessianTerms::all) H += k * gap.value * gap.hessian;
      add(i, i, (1 - share) * (1 - share) * H);
      if (share == 0) return;
      add(i + 1, i + 1, share * share * H);
      add(i + 1, i, share * (1 - share) * H);
      add(i, i + 1, share * (1 - share) * H);
    };
    for_each_sample(held, obstacle, points, stiffen);
  }
}

}  // namespace

AngleJoint joint_by_angle(JointLaw law, double stiffness, double L, double alpha) {
  if (law == JointLaw::linear) {
    const double k = stiffness / L;
    return {k * alpha * alpha / 2, k * alpha, k};
  }
  const double followed =
      law == JointLaw::paper ? alpha : std::clamp(alpha, -fold_angle, fold_angle);
  const double s = std::sin(followed / 2);
  const double c = std::cos(followed / 2);
  if (law == JointLaw::paper) {
    const double quarter = std::sin(alpha / 4);
    const double m = 2 * quarter * quarter;  // 1 - cos(alpha/2), without cancellation
    const double scale = stiffness * L;
    return {scale * 4 * m * m * (1 - m / 3), scale * 2 * s * s * s, scale * 3 * s * s * c};
  }
  // h = s^2, so that dh / d alpha = s c
  const Joint by_h = joint(law, stiffness, L, s * s);
  const double moment = by_h.first * s * c;
  const double second = by_h.second * s * s * c * c + by_h.first * (c * c - s * s) / 2;
  return {by_h.energy + moment * (alpha - followed), moment, followed == alpha ? second : 0};
}

void add_difference_block(Eigen::Index p, Eigen::Index q, const Eigen::Matrix3d& H,
                          const AddBlock& add) {
  add(p + 1, q + 1, H);
  add(p + 1, q, -H);
  add(p, q + 1, -H);
  add(p, q, H);
}

double polygon_energy(const PolygonProblem& problem, const Points& points,
                      Eigen::Ref<Eigen::Matrix3Xd> gradient) {
  const Eigen::Index n = problem.rest_lengths.size();
  gradient = -problem.node_forces;
  double energy = -problem.node_forces.cwiseProduct(points).sum();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d d = points.col(i + 1) - points.col(i);
    const double L = problem.rest_lengths[i];
    const double longer = d.norm() - L;
    energy += problem.stretch_stiffness * longer * longer / (2 * L);
    const Eigen::Vector3d pull = problem.stretch_stiffness * longer / L * d.normalized();
    gradient.col(i + 1) += pull;
    gradient.col(i) -= pull;
  }
  for (Eigen::Index i = 1; i < n; ++i) {
    const Corner corner(points, i);
    const Joint j = joint(problem.law, joint_stiffness(problem, i),
                          joint_length(problem.rest_lengths, i), corner.h);
    energy += j.energy;
    // h = (1 - cos alpha) / 2
    Eigen::Vector3d by_a = -j.first / 2 * corner.by_a;
    Eigen::Vector3d by_b = -j.first / 2 * corner.by_b;
    if (problem.natural_turns.size() > 0) {
      const NaturalTurn natural = natural_turn(problem, i);
      const double alpha = std::atan2(corner.u.x() * corner.v.y() - corner.u.y() * corner.v.x(),
                                      corner.u.dot(corner.v));
      energy -= natural.constant + natural.couple * alpha;
      by_a += natural.couple / corner.a * rotated_left(corner.u);
      by_b -= natural.couple / corner.b * rotated_left(corner.v);
    }
    gradient.col(i - 1) -= by_a;
    gradient.col(i) += by_a - by_b;
    gradient.col(i + 1) += by_b;
  }
  energy += add_twist_energy(problem, points, gradient);
  if (problem.obstacles.empty()) return energy;
  const std::vector<bool> held = held_points(problem);
  for (const PointObstacle& obstacle : problem.obstacles) {
    const auto push = [&](Eigen::Index i, double share, const Eigen::Vector3d& point) {
      if (obstacle.body.clearance(point) >= 0) return;
      const double k = sample_stiffness(obstacle, i, share);
      const obstacle::Gap gap = obstacle.body.gap(point);
      energy += k * gap.value * gap.value / 2;
      const Eigen::Vector3d by_point = k * gap.value * gap.gradient;
      gradient.col(i) += (1 - share) * by_point;
      if (share > 0) gradient.col(i + 1) += share * by_point;
    };
    for_each_sample(held, obstacle, points, push);
  }
  return energy;
}

void polygon_hessian(const PolygonProblem& problem, const Points& points, HessianTerms which,
                     const AddBlock& add) {
  const bool all = which == HessianTerms::all;
  const Eigen::Index n = problem.rest_lengths.size();
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d d = points.col(i + 1) - points.col(i);
    const double L = problem.rest_lengths[i];
    const double length = d.norm();
    const Eigen::Vector3d u = d / length;
    const double along = problem.stretch_stiffness / L;
    const double turning = along * (length - L) / length;
    const double across = all ? turning : std::max(turning, 0.0);
    add_difference_block(i, i, across * one + (along - across) * u * u.transpose(), add);
  }
  for (Eigen::Index i = 1; i < n; ++i) {
    const Corner c(points, i);
    const Joint j =
        joint(problem.law, joint_stiffness(problem, i), joint_length(problem.rest_lengths, i), c.h);
    const double curved = (all ? j.second : std::max(j.second, 0.0)) / 4;
    const double slope = -j.first / 2;  // derivative of the potential by cos alpha
    const Eigen::Matrix3d projector_u = one - c.u * c.u.transpose();
    const Eigen::Matrix3d projector_v = one - c.v * c.v.transpose();
    // h is |v - u|^2 / 4. The part of its second derivative from first-order changes of u and v is
    // never negative.
    Eigen::Matrix3d of_u = projector_u / c.a;
    Eigen::Matrix3d of_v = projector_v / c.b;
    if (all) {
      const double cosine = 1 - 2 * c.h;
      of_u = c.u * c.by_a.transpose() + c.by_a * c.u.transpose() + cosine / c.a * projector_u;
      of_v = c.v * c.by_b.transpose() + c.by_b * c.v.transpose() + cosine / c.b * projector_v;
    }
    Eigen::Matrix3d aa = curved * c.by_a * c.by_a.transpose() - slope / c.a * of_u;
    Eigen::Matrix3d bb = curved * c.by_b * c.by_b.transpose() - slope / c.b * of_v;
    const Eigen::Matrix3d ab =
        curved * c.by_a * c.by_b.transpose() + slope / (c.a * c.b) * projector_u * projector_v;
    if (all && problem.natural_turns.size() > 0) {
      const double couple = natural_turn(problem, i).couple;
      aa += couple * angle_hessian(c.u, c.a);
      bb -= couple * angle_hessian(c.v, c.b);
    }
    add_difference_block(i - 1, i - 1, aa, add);
    add_difference_block(i, i, bb, add);
    add_difference_block(i - 1, i, ab, add);
    add_difference_block(i, i - 1, ab.transpose(), add);
  }
  add_twist_hessian(problem, points, add);
  if (!problem.obstacles.empty()) add_obstacle_hessian(problem, points, which, add);
}

}  // namespace dlo::energy_model
