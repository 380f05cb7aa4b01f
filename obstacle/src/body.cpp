#include "dlo/obstacle/body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dlo::obstacle {
namespace {

/// Returns orthonormal axes, one of which has the given direction.
Eigen::Matrix3d axes_with(Eigen::Index axis, const Eigen::Vector3d& direction) {
  Eigen::Matrix3d axes;
  axes.col(axis) = direction.normalized();
  axes.col((axis + 1) % 3) = axes.col(axis).unitOrthogonal();
  axes.col((axis + 2) % 3) = axes.col(axis).cross(axes.col((axis + 1) % 3));
  return axes;
}

/// Returns the vector from the nearest point of a block to a point; zero inside the block.
Eigen::Vector3d vector_from_block(const Eigen::Vector3d& local, const Eigen::Vector3d& lower,
                                  const Eigen::Vector3d& upper) {
  return local - local.cwiseMax(lower).cwiseMin(upper);
}

/// Face of a block that is nearest to a point.
struct Face {
  Eigen::Index axis = 0;
  double sign = 1;
  double depth = std::numeric_limits<double>::infinity();
};

Face nearest_face(const Eigen::Vector3d& local, const Eigen::Vector3d& lower,
                  const Eigen::Vector3d& upper) {
  Face nearest;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double up = upper[axis] - local[axis];
    const double down = local[axis] - lower[axis];
    if (up < nearest.depth) nearest = {axis, 1, up};
    if (down < nearest.depth) nearest = {axis, -1, down};
  }
  return nearest;
}

}  // namespace

Body Body::half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  Body body;
  body.centre_ = point;
  body.axes_ = axes_with(1, normal);
  return body;
}

Body Body::sphere(const Eigen::Vector3d& centre, double radius) {
  return capsule(centre, Eigen::Vector3d::UnitX(), 0, radius);
}

Body Body::cylinder(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double radius) {
  return capsule(point, axis, infinite, radius);
}

Body Body::capsule(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis, double length,
                   double radius) {
  Body body;
  body.centre_ = centre;
  body.axes_ = axes_with(0, axis);
  body.upper_ = {length / 2, 0, 0};
  body.lower_ = -body.upper_;
  body.radius_ = radius;
  return body;
}

Body Body::box(const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
               const Eigen::Vector3d& size, double radius) {
  Body body;
  body.centre_ = centre;
  body.axes_ = axes;
  body.upper_ = (size / 2).array() - radius;
  body.lower_ = -body.upper_;
  body.radius_ = radius;
  return body;
}

Body Body::with_rounded_edges(double share) const {
  Body body = *this;
  if (is_half_space()) return body;
  body.radius_ += share * upper_.minCoeff();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (std::isinf(upper_[axis])) continue;
    body.upper_[axis] *= 1 - share;
    body.lower_[axis] *= 1 - share;
  }
  return body;
}

Body Body::enlarged(double by) const {
  Body body = *this;
  body.radius_ += by;
  return body;
}

Body Body::transformed(const Eigen::Vector3d& origin, const Eigen::Matrix3d& turn,
                       double unit) const {
  Body body;
  body.centre_ = turn * (centre_ - origin) / unit;
  body.axes_ = turn * axes_;
  body.lower_ = lower_ / unit;
  body.upper_ = upper_ / unit;
  body.radius_ = radius_ / unit;
  return body;
}

Gap Body::gap(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = axes_.transpose() * (point - centre_);
  const Eigen::Vector3d out = vector_from_block(local, lower_, upper_);
  const double distance = out.norm();
  if (!(distance > 0)) {
    const Face face = nearest_face(local, lower_, upper_);
    return {-face.depth - radius_, face.sign * axes_.col(face.axis), Eigen::Matrix3d::Zero()};
  }
  Gap gap;
  gap.value = distance - radius_;
  gap.gradient = axes_ * (out / distance);
  // Above a face, where only one axis leads out of the core, the surface is flat. If the core has
  // no width along an axis, points are outside of it along this axis, even directly above it.
  const Eigen::Array3d leaves =
      (out.array() != 0 || lower_.array() == upper_.array()).cast<double>();
  if (leaves.sum() > 1) {
    const Eigen::Matrix3d across = axes_ * leaves.matrix().asDiagonal() * axes_.transpose();
    gap.hessian = (across - gap.gradient * gap.gradient.transpose()) / distance;
  }
  return gap;
}

double Body::clearance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = axes_.transpose() * (point - centre_);
  const double distance = vector_from_block(local, lower_, upper_).norm();
  if (distance > 0) return distance - radius_;
  return -nearest_face(local, lower_, upper_).depth - radius_;
}

Eigen::VectorXd Body::clearances(const Eigen::Ref<const Eigen::Matrix3Xd>& points) const {
  if (is_half_space()) {
    return (normal().transpose() * (points.colwise() - centre_)).transpose().array() - radius_;
  }
  Eigen::VectorXd result(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) result[i] = clearance(points.col(i));
  return result;
}

int Body::feature(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = axes_.transpose() * (point - centre_);
  Eigen::Vector3d out = vector_from_block(local, lower_, upper_);
  if (!(out.squaredNorm() > 0)) {
    const Face face = nearest_face(local, lower_, upper_);
    out[face.axis] = face.sign;
  }
  int number = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    // Both sides of an axis without width are the same feature.
    const bool flat = upper_[axis] == lower_[axis];
    const int side = flat || out[axis] == 0 ? 0 : out[axis] > 0 ? 1 : 2;
    number = 3 * number + side;
  }
  return number;
}

bool Body::is_half_space() const {
  return std::isinf(lower_.y()) && std::isinf(upper_.x()) && std::isfinite(upper_.y());
}

double Body::smallest_radius() const { return is_half_space() ? infinite : radius_; }

bool Body::is_symmetric(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                        double unit) const {
  constexpr double rounding = 1e-9;
  if (is_half_space()) return std::abs(this->normal().dot(normal)) < rounding;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!(upper_[axis] > 0)) continue;
    const Eigen::Vector3d along = axes_.col(axis);
    const bool parallel = along.cross(normal).norm() < rounding;
    if (parallel && std::isinf(upper_[axis])) return true;
    if (!parallel && std::abs(along.dot(normal)) > rounding) return false;
  }
  return std::abs(normal.dot(point - centre_)) < rounding * unit;
}

int samples_per_segment(const Body& body, double length) {
  constexpr double most = 16;
  return static_cast<int>(std::clamp(std::ceil(2 * length / body.smallest_radius()), 1.0, most));
}

}  // namespace dlo::obstacle
