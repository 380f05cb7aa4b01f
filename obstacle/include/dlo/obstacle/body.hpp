#pragma once

#include <Eigen/Core>
#include <limits>

namespace dlo::obstacle {

/// Signed distance of a point from a body's surface, > 0 outside, and its derivatives by the point.
struct Gap {
  double value = 0;                                     ///< [m]
  Eigen::Vector3d gradient = Eigen::Vector3d::UnitY();  ///< unit vector away from the body [-]
  /// Second derivative, the curvature of the parallel surface through the point [1/m].
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// Solid body: all points within a radius of its core, which is a block with edges along three
/// axes, each of them finite, zero or infinitely long. It can be a half-space, a sphere (the core
/// is a point), a cylinder (a line), a capsule (a segment) or a block with rounded edges. If a
/// rod's surface touches the body, its axis is on the same body grown by the rod's radius.
///
/// Both models of a rod use this distance for contact with a body. Outside of the core it is
/// smooth, except that its curvature jumps where a face meets an edge. Inside the core it is minus
/// the distance from the nearest face of the body.
class Body {
 public:
  /// Creates the half-space y < 0.
  Body() = default;

  /// Returns the half-space behind a plane. @param normal  towards the free side, any length > 0
  [[nodiscard]] static Body half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
  /// Returns a sphere. @param radius  [m], > 0
  [[nodiscard]] static Body sphere(const Eigen::Vector3d& centre, double radius);
  /// Returns a cylinder without ends. @param axis  any length > 0; @param radius  [m], > 0
  [[nodiscard]] static Body cylinder(const Eigen::Vector3d& point, const Eigen::Vector3d& axis,
                                     double radius);
  /// Returns a cylinder with a hemisphere at either end. @param length  distance of the spheres'
  /// centres [m], >= 0
  [[nodiscard]] static Body capsule(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                                    double length, double radius);
  /// Returns a block.
  /// @param axes    directions of its edges, orthonormal columns
  /// @param size    lengths of its edges [m]
  /// @param radius  radius of its rounded edges, which are within its size [m]
  [[nodiscard]] static Body box(const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                                const Eigen::Vector3d& size, double radius);

  /// Returns a body inside this one with rounder edges: this body for 0, and for 1 a sphere around
  /// the middle of the core with the body's thickness. Infinite dimensions stay infinite.
  [[nodiscard]] Body with_rounded_edges(double share) const;
  /// Returns the body with its surface moved outwards by `by` [m].
  [[nodiscard]] Body enlarged(double by) const;
  /// Returns the body in coordinates in which a point x is turn (x - origin) / unit.
  [[nodiscard]] Body transformed(const Eigen::Vector3d& origin, const Eigen::Matrix3d& turn,
                                 double unit) const;

  /// Returns the signed distance of a point, with derivatives.
  [[nodiscard]] Gap gap(const Eigen::Vector3d& point) const;
  /// Returns the signed distance of a point [m], > 0 outside, without derivatives.
  [[nodiscard]] double clearance(const Eigen::Vector3d& point) const;
  /// Returns the signed distances of M points [m], > 0 outside, without derivatives.
  /// @param points  3 x M [m]
  [[nodiscard]] Eigen::VectorXd clearances(const Eigen::Ref<const Eigen::Matrix3Xd>& points) const;

  /// Returns a number that identifies the face, edge or corner of the core that is nearest to a
  /// point. The surface is smooth over points with the same number.
  [[nodiscard]] int feature(const Eigen::Vector3d& point) const;

  /// Whether the body is a half-space, which has a normal().
  [[nodiscard]] bool is_half_space() const;
  /// Returns the normal of a half-space.
  [[nodiscard]] Eigen::Vector3d normal() const { return axes_.col(1); }
  /// Returns the smallest radius of curvature of the surface [m]; infinite for a half-space, 0 for
  /// sharp edges.
  [[nodiscard]] double smallest_radius() const;
  /// Whether the body equals its mirror image in the plane through `point` with this unit normal,
  /// up to rounding. For blocks with two equal edges that are rotated by 45 degrees the result is
  /// false.
  /// @param unit  length with which rounding is compared [m]
  [[nodiscard]] bool is_symmetric(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  double unit) const;

  /// Returns the point where the axes of the core meet [m]; for a half-space a point of the plane
  /// from which the surface is radius() away.
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  /// Axes of the core, columns.
  [[nodiscard]] const Eigen::Matrix3d& axes() const { return axes_; }
  /// Lower ends of the core along its axes, from the centre [m].
  [[nodiscard]] const Eigen::Vector3d& lower() const { return lower_; }
  [[nodiscard]] const Eigen::Vector3d& upper() const { return upper_; }  ///< >= lower()
  [[nodiscard]] double radius() const { return radius_; }  ///< radius about the core [m]

  /// Whether all members are equal.
  bool operator==(const Body&) const = default;

 private:
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d lower_ = Eigen::Vector3d::Constant(-infinite);
  Eigen::Vector3d upper_ = Eigen::Vector3d(infinite, 0, infinite);
  double radius_ = 0;

  static constexpr double infinite = std::numeric_limits<double>::infinity();
};

/// Returns the number of samples per segment at which a polygon must be checked against a body, so
/// that the body cannot pass between two of them. Samples are at most half of the smallest radius
/// apart. There are at most 16 per segment, and thinner bodies can pass.
/// @param length  length of a segment [m], > 0
[[nodiscard]] int samples_per_segment(const Body& body, double length);

}  // namespace dlo::obstacle
