#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "dlo/force_model/rod.hpp"
#include "point_masses.hpp"
#include "solid_samples.hpp"

// Minus the derivatives of the forces by the points, term by term. `Stiffness` takes
//     add(i, j, block)    -df_i/dx_j, i <= j, with its transpose when i != j

namespace dlo::force_model {

/// Adds contraction: c_c/L along each segment, and the transverse stiffness due to its tension.
/// @param largest_compression  largest reduction of the transverse stiffness by compression, as a
/// fraction of c_c/L [-]
template <typename Stiffness>
void add_segments(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                  double largest_compression, Stiffness& stiffness) {
  // A segment of zero length has no direction: all directions then have the transverse stiffness.
  constexpr double no_length = 1e-9;
  for (Eigen::Index i = 0; i < rod.rest_lengths.size(); ++i) {
    const double L = rod.rest_lengths[i];
    const Eigen::Vector3d segment = points.col(i + 1) - points.col(i);
    const double length = std::max(segment.norm(), no_length * L);
    const Eigen::Vector3d u = segment / length;
    const double across =
        std::max(rod.c_c * (length - L) / L / length, -largest_compression * rod.c_c / L);
    const Eigen::Matrix3d along = u * u.transpose();
    const Eigen::Matrix3d block =
        rod.c_c / L * along + across * (Eigen::Matrix3d::Identity() - along);
    stiffness.add(i, i, block);
    stiffness.add(i + 1, i + 1, block);
    stiffness.add(i, i + 1, -block);
  }
}

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Common factor of a joint's forces. In both laws the forces by its two segments a, b are S
/// dc/d(a, b), with the cosine c of its angle. S and its derivative by (a, b):
///     hooke:  S = 2 (EI/L) / (1 + c),              beyond the fold angle M / sin(alpha)
///     paper:  S = c_b (1 - c) |a| |b| / |a + b|
struct JointFactor {
  double S = 0;
  Vector6d slope = Vector6d::Zero();
};

[[nodiscard]] JointFactor joint_factor(const Bending& bending, double L, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, double c,
                                       const Vector6d& slope_of_c);

/// Returns the second derivative by s of the angle of s in the plane z = 0.
[[nodiscard]] Eigen::Matrix3d second_of_direction_angle(const Eigen::Vector3d& s);

/// Adds a joint's second derivatives by its segments a = P_i - P_{i-1} and b = P_{i+1} - P_i.
template <typename Stiffness>
void add_joint(Eigen::Index i, const Eigen::Matrix3d& A, const Eigen::Matrix3d& AB,
               const Eigen::Matrix3d& B, Stiffness& stiffness) {
  stiffness.add(i - 1, i - 1, A);
  stiffness.add(i, i, A + B - AB - AB.transpose());
  stiffness.add(i + 1, i + 1, B);
  stiffness.add(i - 1, i, AB - A);
  stiffness.add(i - 1, i + 1, -AB);
  stiffness.add(i, i + 1, AB - B);
}

/// Adds bending, including the couples of natural angles.
template <typename Stiffness>
void add_joints(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                Stiffness& stiffness) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (Eigen::Index i = 1; i < rod.rest_lengths.size(); ++i) {
    const Eigen::Vector3d a = points.col(i) - points.col(i - 1);
    const Eigen::Vector3d b = points.col(i + 1) - points.col(i);
    const double a_length = a.norm();
    const double b_length = b.norm();
    if (!(a_length > 0 && b_length > 0)) continue;
    const Eigen::Vector3d u = a / a_length;
    const Eigen::Vector3d v = b / b_length;
    const double c = u.dot(v);
    const Eigen::Vector3d by_a = v - c * u;  // |a| dc/da
    const Eigen::Vector3d by_b = u - c * v;  // |b| dc/db
    Vector6d slope;
    slope << by_a / a_length, by_b / b_length;
    const Eigen::Matrix3d aa = by_a * u.transpose();
    const Eigen::Matrix3d bb = by_b * v.transpose();
    Matrix6d second;  // second derivatives of c
    second.topLeftCorner<3, 3>() =
        -(aa + aa.transpose() + c * (one - u * u.transpose())) / (a_length * a_length);
    second.bottomRightCorner<3, 3>() =
        -(bb + bb.transpose() + c * (one - v * v.transpose())) / (b_length * b_length);
    second.topRightCorner<3, 3>() =
        (one - v * v.transpose() - u * by_b.transpose()) / (a_length * b_length);
    second.bottomLeftCorner<3, 3>() = second.topRightCorner<3, 3>().transpose();
    const double L = (rod.rest_lengths[i - 1] + rod.rest_lengths[i]) / 2;
    const JointFactor factor = joint_factor(bending_at(rod.bending, i), L, a, b, c, slope);
    const Matrix6d turning = slope * factor.slope.transpose();
    const Matrix6d by_segments = -(turning + turning.transpose()) / 2 - factor.S * second;
    Eigen::Matrix3d A = by_segments.topLeftCorner<3, 3>();
    Eigen::Matrix3d B = by_segments.bottomRightCorner<3, 3>();
    if (rod.bending.natural_turns.size() > 0) {
      // The potential of a natural couple is -C (angle of b - angle of a).
      const double couple = natural_moment(rod.bending, i, L);
      A += couple * second_of_direction_angle(a);
      B -= couple * second_of_direction_angle(b);
    }
    const Eigen::Matrix3d AB = by_segments.topRightCorner<3, 3>();
    add_joint(i, A, AB, B, stiffness);
  }
}

template <typename Stiffness>
void add_walls(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
               Stiffness& stiffness) {
  for (const Wall& wall : rod.walls) {
    const Eigen::Matrix3d block = wall.stiffness * wall.normal * wall.normal.transpose();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      if ((wall.point - points.col(i)).dot(wall.normal) > 0) stiffness.add(i, i, block);
    }
  }
}

/// Adds solids and spring grips.
template <typename Stiffness>
void add_springs(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                 Stiffness& stiffness) {
  const auto at = [&points](Eigen::Index i) -> Eigen::Vector3d { return points.col(i); };
  for (const Solid& solid : rod.solids) {
    for_each_push(solid, points.cols(), at, [&](const SolidPush& push) {
      const Eigen::Vector3d& normal = push.gap.gradient;
      const Eigen::Matrix3d block =
          solid.stiffness / solid.samples *
          (normal * normal.transpose() + push.gap.value * push.gap.hessian);
      const double own = 1 - push.share;
      stiffness.add(push.point, push.point, own * own * block);
      if (push.share == 0) return;
      stiffness.add(push.point + 1, push.point + 1, push.share * push.share * block);
      stiffness.add(push.point, push.point + 1, own * push.share * block);
    });
  }
  for_each_grip_point(rod, GripHold::spring, [&](const Grip& grip, Eigen::Index k) {
    const Eigen::Matrix3d block = grip.stiffness * Eigen::Matrix3d::Identity();
    stiffness.add(grip.first_point + k, grip.first_point + k, block);
  });
}

}  // namespace dlo::force_model
