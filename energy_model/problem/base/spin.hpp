#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

namespace dlo::energy_model {

/// Component of a unit vector, and angle [rad], that count as rounding.
inline constexpr double direction_rounding = 1e-9;

/// Returns the equivalent angle in (-pi, pi]. An angle of -pi up to rounding becomes pi.
inline double wrap_to_pi(double angle) {
  const double least = std::remainder(angle, 2 * std::numbers::pi);
  return least < direction_rounding - std::numbers::pi ? std::numbers::pi : least;
}

/// Returns the part of a vector across a unit vector.
inline Eigen::Vector3d part_across(const Eigen::Vector3d& vector,
                                   const Eigen::Vector3d& direction) {
  return vector - vector.dot(direction) * direction;
}

/// Returns the matrix whose product with w is v x w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Returns the cross products of the rows of a with the rows of b.
inline Eigen::MatrixX3d cross_rows(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b) {
  Eigen::MatrixX3d result(a.rows(), 3);
  result.col(0) = a.col(1).cwiseProduct(b.col(2)) - a.col(2).cwiseProduct(b.col(1));
  result.col(1) = a.col(2).cwiseProduct(b.col(0)) - a.col(0).cwiseProduct(b.col(2));
  result.col(2) = a.col(0).cwiseProduct(b.col(1)) - a.col(1).cwiseProduct(b.col(0));
  return result;
}

/// Returns the rotation about v by the angle |v| [rad].
inline Eigen::Quaterniond from_rotation_vector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const double half_sine = angle > 1e-8 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), half_sine * v.x(), half_sine * v.y(), half_sine * v.z()};
}

/// Returns the frame (d1, d2, t) with this unit tangent, whose d1 is the normalised part of the
/// given d1 across the tangent.
inline Eigen::Matrix3d frame_along(const Eigen::Vector3d& tangent, const Eigen::Vector3d& d1) {
  const Eigen::Vector3d first = (d1 - tangent.dot(d1) * tangent).normalized();
  Eigen::Matrix3d frame;
  frame << first, tangent.cross(first), tangent;
  return frame;
}

/// Returns the frame rotated about its tangent by an angle [rad].
inline Eigen::Matrix3d rolled(const Eigen::Matrix3d& frame, double angle) {
  return from_rotation_vector(angle * Eigen::Vector3d(frame.col(2))) * frame;
}

/// Returns the frame transported to another unit tangent by the shortest rotation.
inline Eigen::Matrix3d transported(const Eigen::Matrix3d& frame, const Eigen::Vector3d& tangent) {
  const Eigen::Vector3d t = frame.col(2);
  return frame_along(tangent, Eigen::Quaterniond::FromTwoVectors(t, tangent) * frame.col(0));
}

/// Returns the Hessian of g . p with respect to a spin of the director p: sym(g p^T) - (g.p) 1.
inline Eigen::Matrix3d spin_hessian(const Eigen::Vector3d& p, const Eigen::Vector3d& g) {
  Eigen::Matrix3d a = (g * p.transpose() + p * g.transpose()) / 2;
  a.diagonal().array() -= g.dot(p);
  return a;
}

/// Returns the shortest rotation of a unit vector into another. If they are opposite, it is about
/// the normal of the plane of the vectors and the chord, and empty if the chord is along them.
/// @param chord  vector between the points at which the vectors are tangents, divided by the length
inline std::optional<Eigen::Quaterniond> shortest_rotation(const Eigen::Vector3d& first,
                                                           const Eigen::Vector3d& last,
                                                           const Eigen::Vector3d& chord) {
  if (first.dot(last) > direction_rounding - 1)
    return Eigen::Quaterniond::FromTwoVectors(first, last);
  const Eigen::Vector3d normal = first.cross(chord);
  if (!(normal.norm() > direction_rounding)) return std::nullopt;
  return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, normal.normalized()));
}

}  // namespace dlo::energy_model
