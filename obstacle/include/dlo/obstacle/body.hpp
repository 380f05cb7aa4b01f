#pragma once

#include <Eigen/Core>
#include <limits>

namespace dlo::obstacle {

/// Signed distance of a point from a body's surface, outside > 0, and its derivatives by the point.
struct Gap {
  double value = 0;                                     ///< [m]
  Eigen::Vector3d gradient = Eigen::Vector3d::UnitY();  ///< unit, away from the body [-]
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();    ///< curvature of the surface [1/m]
};

/// A solid body: all points within a radius of its core, which is a block with edges along three
/// axes, any of them zero or infinitely long. So it is a half-space, a sphere (the core is a
/// point), a cylinder (a line), a capsule (a segment) or a block with round edges. A rod that
/// touches it with its surface has its axis on the same body, grown by the rod's radius.
///
/// The distance is the one definition of contact that both models of a rod have. Outside of the
/// core it is smooth but for the curvature, which jumps where a face meets an edge; inside a block
/// it is that from the nearest face.
class Body {
 public:
  /// The half-space y < 0.
  Body() = default;

  /// All that is behind a plane. @param normal  to the free side, any length > 0
  [[nodiscard]] static Body half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
  /// A ball. @param radius  [m], > 0
  [[nodiscard]] static Body sphere(const Eigen::Vector3d& centre, double radius);
  /// One without ends. @param axis  any length > 0; @param radius  [m], > 0
  [[nodiscard]] static Body cylinder(const Eigen::Vector3d& point, const Eigen::Vector3d& axis,
                                     double radius);
  /// A cylinder with a half ball at either end. @param length  between the balls' centres [m], >= 0
  [[nodiscard]] static Body capsule(const Eigen::Vector3d& centre, const Eigen::Vector3d& axis,
                                    double length, double radius);
  /// A block. @param axes  of its edges, columns, orthonormal; @param size  of its edges [m];
  /// @param radius  of what its edges are rounded with, within its size [m]
  [[nodiscard]] static Body box(const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                                const Eigen::Vector3d& size, double radius);

  /// Within itself, with rounder edges: from itself, 0, to a ball around the core's middle, 1, of
  /// what it is as thick as; what is endless stays so.
  [[nodiscard]] Body rounded(double share) const;
  /// With a surface that is farther out by this [m].
  [[nodiscard]] Body grown(double by) const;
  /// Where a point x is called turn (x - origin) / unit.
  [[nodiscard]] Body seen_from(const Eigen::Vector3d& origin, const Eigen::Matrix3d& turn,
                               double unit) const;

  /// Of a point, with derivatives.
  [[nodiscard]] Gap gap(const Eigen::Vector3d& point) const;
  /// Its value alone.
  [[nodiscard]] double clearance(const Eigen::Vector3d& point) const;
  /// That of many. @param points  3 x M
  [[nodiscard]] Eigen::VectorXd clearances(const Eigen::Ref<const Eigen::Matrix3Xd>& points) const;

  /// Which face, edge or corner of the core a point is next to, by a number of its own; points next
  /// to the same one see a smooth surface.
  [[nodiscard]] int feature(const Eigen::Vector3d& point) const;

  /// Whether it ends in one plane, which has a normal().
  [[nodiscard]] bool is_half_space() const;
  /// Of a half-space.
  [[nodiscard]] Eigen::Vector3d normal() const { return axes_.col(1); }
  /// Smallest radius of curvature of its surface [m]; infinite of a half-space, 0 of sharp edges.
  [[nodiscard]] double smallest_radius() const;
  /// Whether it is its own mirror image in the plane through `point` with this unit normal, but for
  /// rounding; of blocks with two equal edges that are rotated by half a right angle it is not
  /// said.
  /// @param unit  of length, what rounding is measured by [m]
  [[nodiscard]] bool is_symmetric(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  double unit) const;

  /// Where the core's axes meet; of a half-space a point of its plane [m].
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  [[nodiscard]] const Eigen::Matrix3d& axes() const { return axes_; }    ///< of the core, columns
  [[nodiscard]] const Eigen::Vector3d& lower() const { return lower_; }  ///< of the core, on them
  [[nodiscard]] const Eigen::Vector3d& upper() const { return upper_; }  ///< >= lower()
  [[nodiscard]] double radius() const { return radius_; }                ///< about the core [m]

  /// In every field.
  bool operator==(const Body&) const = default;

 private:
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d lower_ = Eigen::Vector3d::Constant(-infinite);
  Eigen::Vector3d upper_ = Eigen::Vector3d(infinite, 0, infinite);
  double radius_ = 0;

  static constexpr double infinite = std::numeric_limits<double>::infinity();
};

/// At how many points to a segment a polygon has to be held against a body, so that it does not
/// slip between two of them: they are no farther apart than half of its smallest radius, but for 16
/// to a segment. @param length  of a segment [m]
[[nodiscard]] int samples_per_segment(const Body& body, double length);

}  // namespace dlo::obstacle
