#include "dlo/force_model/bending.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "require.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Relative length below which the direction of a chord is determined by rounding.
constexpr double fold_chord = 1e-12;

void require_joint(const char* function, const Bending& bending, double segment_length,
                   double alpha) {
  require_not_negative(function, "bending stiffness", bending.stiffness);
  require_positive(function, "segment_length", segment_length);
  require(alpha >= 0 && alpha <= std::numbers::pi, function, "alpha", alpha, "in [0, pi]");
}

/// Returns the component of `force` that is orthogonal to the unit vector `direction`.
Eigen::Vector3d orthogonal_part(const Eigen::Vector3d& force, const Eigen::Vector3d& direction) {
  return force - force.dot(direction) * direction;
}

/// Forces of one joint on its two outer points.
struct JointForces {
  Eigen::Vector3d on_previous;
  Eigen::Vector3d on_next;
};

JointForces paper_forces(double c_b, const Eigen::Vector3d& u, double a, const Eigen::Vector3d& v,
                         double b) {
  const Eigen::Vector3d chord = a * u + b * v;
  const double length = chord.norm();
  const Eigen::Vector3d e = length > fold_chord * (a + b) ? Eigen::Vector3d(chord / length)
                                                          : Eigen::Vector3d(u.unitOrthogonal());
  const Eigen::Vector3d F = c_b * (1 - u.dot(v)) * e;      // (3)
  return {-orthogonal_part(F, u), orthogonal_part(F, v)};  // (4), signs as in the header
}

JointForces hooke_forces(double EI_over_L, const Eigen::Vector3d& u, double a,
                         const Eigen::Vector3d& v, double b) {
  const double cosine = u.dot(v);
  static const double fold_cosine = std::cos(hooke_fold_angle);
  if (cosine >= fold_cosine) {
    const double k = 2 * EI_over_L / (1 + cosine);
    return {-k / a * (v - cosine * u), k / b * (u - cosine * v)};
  }
  // Beyond the fold angle the moment is constant, and acts along the directions in which the joint
  // opens.
  const double moment = 2 * EI_over_L * std::tan(hooke_fold_angle / 2);
  const Eigen::Vector3d opening = u + v;
  const Eigen::Vector3d e = opening.norm() > fold_chord ? Eigen::Vector3d(opening.normalized())
                                                        : Eigen::Vector3d(u.unitOrthogonal());
  return {-moment / a * orthogonal_part(e, u).normalized(),
          moment / b * orthogonal_part(e, v).normalized()};
}

/// Returns the angle from a to b, seen from +z [rad]; 0 if one of them is zero. Adding zero avoids
/// atan2(0, -0), which is pi.
double signed_turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y() + 0.0);
}

/// Returns a vector of the plane z = 0, rotated to the left by a right angle.
Eigen::Vector3d rotated_left(const Eigen::Vector3d& vector) { return {-vector.y(), vector.x(), 0}; }

/// Returns the angle between a and b, in [0, pi]; 0 if one of them is zero, as signed_turn().
double turning_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b) + 0.0);
}

}  // namespace

Bending bending_at(const Bending& bending, Eigen::Index i) {
  return {bending.law,
          bending.stiffnesses.size() > 0 ? bending.stiffnesses[i - 1] : bending.stiffness};
}

double natural_moment(const Bending& bending, Eigen::Index i, double segment_length) {
  if (bending.natural_turns.size() == 0) return 0;
  return 2 * bending_at(bending, i).stiffness / segment_length *
         std::tan(bending.natural_turns[i - 1] / 2);
}

void check(const Bending& bending, Eigen::Index segments) {
  require_not_negative("Bending", "stiffness", bending.stiffness);
  const auto require_each = [&](const Eigen::VectorXd& numbers, const char* size) {
    require(numbers.size() == 0 || numbers.size() == segments - 1, "Bending", size,
            static_cast<double>(numbers.size()), "0 or the number of joints");
  };
  require_each(bending.stiffnesses, "size of stiffnesses");
  require_each(bending.natural_turns, "size of natural_turns");
  for (const double stiffness : bending.stiffnesses) {
    require_not_negative("Bending", "stiffness of a joint", stiffness);
  }
  if (bending.natural_turns.size() == 0) return;
  require(bending.law == BendingLaw::hooke, "Bending", "number of natural turns",
          static_cast<double>(bending.natural_turns.size()), "0 for the paper's law");
  for (const double turn : bending.natural_turns) {
    require(std::abs(turn) < hooke_fold_angle, "Bending", "natural turn", turn, "in (-3, 3) rad");
  }
}

double joint_moment(const Bending& bending, double segment_length, double alpha) {
  require_joint("joint_moment", bending, segment_length, alpha);
  if (bending.law == BendingLaw::paper) {
    const double s = std::sin(alpha / 2);
    return 2 * bending.stiffness * segment_length * s * s * s;
  }
  return 2 * bending.stiffness / segment_length * std::tan(std::min(alpha, hooke_fold_angle) / 2);
}

double joint_potential(const Bending& bending, double segment_length, double alpha) {
  require_joint("joint_potential", bending, segment_length, alpha);
  if (bending.law == BendingLaw::paper) {
    // (8/3 - 4 cos + 4/3 cos^3)(alpha/2), in a form without cancellation for small angles
    const double s = std::sin(alpha / 4);
    const double one_minus_cos = 2 * s * s;
    return bending.stiffness * segment_length * 4 * one_minus_cos * one_minus_cos *
           (1 - one_minus_cos / 3);
  }
  const double stiffness = bending.stiffness / segment_length;
  const double followed = std::min(alpha, hooke_fold_angle);
  const double quarter = std::sin(followed / 4);
  // ln cos(alpha/2) without cancellation for small angles
  return -4 * stiffness * std::log1p(-2 * quarter * quarter) +
         2 * stiffness * std::tan(followed / 2) * (alpha - followed);
}

double joint_stiffness(const Bending& bending, double segment_length, double alpha) {
  require_joint("joint_stiffness", bending, segment_length, alpha);
  if (bending.law == BendingLaw::paper) {
    const double s = std::sin(alpha / 2);
    return 3 * bending.stiffness * segment_length * s * s * std::cos(alpha / 2);
  }
  if (alpha > hooke_fold_angle) return 0;
  const double c = std::cos(alpha / 2);
  return bending.stiffness / segment_length / (c * c);
}

void add_bending_forces(const Points& points, const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                        const Bending& bending, Eigen::Ref<Eigen::Matrix3Xd> forces) {
  require_polygon("add_bending_forces", points, rest_lengths);
  check(bending, rest_lengths.size());
  require(forces.cols() == points.cols(), "add_bending_forces", "columns of forces",
          static_cast<double>(forces.cols()), "the number of points");
  for (Eigen::Index i = 1; i < rest_lengths.size(); ++i) {
    const Eigen::Vector3d before = points.col(i) - points.col(i - 1);
    const Eigen::Vector3d after = points.col(i + 1) - points.col(i);
    const double a = before.norm();
    const double b = after.norm();
    if (!(a > 0 && b > 0)) continue;
    const Eigen::Vector3d u = before / a;
    const Eigen::Vector3d v = after / b;
    const double L = (rest_lengths[i - 1] + rest_lengths[i]) / 2;
    const double stiffness = bending_at(bending, i).stiffness;
    JointForces joint = bending.law == BendingLaw::paper ? paper_forces(stiffness, u, a, v, b)
                                                         : hooke_forces(stiffness / L, u, a, v, b);
    if (bending.natural_turns.size() > 0) {
      const double couple = natural_moment(bending, i, L);
      joint.on_previous += couple / a * rotated_left(u);
      joint.on_next += couple / b * rotated_left(v);
    }
    forces.col(i - 1) += joint.on_previous;
    forces.col(i + 1) += joint.on_next;
    forces.col(i) -= joint.on_previous + joint.on_next;
  }
}

double bending_energy(const Points& points, const Eigen::Ref<const Eigen::VectorXd>& rest_lengths,
                      const Bending& bending) {
  require_polygon("bending_energy", points, rest_lengths);
  check(bending, rest_lengths.size());
  double energy = 0;
  for (Eigen::Index i = 1; i < rest_lengths.size(); ++i) {
    const double L = (rest_lengths[i - 1] + rest_lengths[i]) / 2;
    const Eigen::Vector3d before = points.col(i) - points.col(i - 1);
    const Eigen::Vector3d after = points.col(i + 1) - points.col(i);
    const Bending joint = bending_at(bending, i);
    energy += joint_potential(joint, L, turning_angle(before, after));
    if (bending.natural_turns.size() == 0) continue;
    const double natural = bending.natural_turns[i - 1];
    energy -= joint_potential(joint, L, std::abs(natural)) +
              natural_moment(bending, i, L) * (signed_turn(before, after) - natural);
  }
  return energy;
}

}  // namespace dlo::force_model
