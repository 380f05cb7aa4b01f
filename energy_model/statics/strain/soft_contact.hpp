#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/legendre.hpp"
#include "frames/span_shape.hpp"

namespace dlo::energy_model {

/// Whether a point in the plane z = 0 of a planar span is equally close to faces of the body on
/// both sides of the plane, about which the body is symmetric. The contact energy has a ridge
/// there.
[[nodiscard]] bool is_on_ridge(const obstacle::Gap& gap);

/// Contact of a span's quadrature nodes with its soft obstacles, which are one-sided springs.
class SoftContact {
 public:
  /// A node within an obstacle.
  struct Pressed {
    Eigen::Index node = 0;
    obstacle::Gap gap;
  };
  /// Nodes within each obstacle, at one shape.
  using Place = std::vector<std::vector<Pressed>>;

  void reset(const Span& span, const std::vector<Piece>& pieces, const LegendreTable& table);

  [[nodiscard]] bool any() const { return !obstacles_.empty(); }

  /// Finds the nodes within obstacles for tangents (nodes x 3), and adds to `force` (nodes x 3) the
  /// obstacles' forces, carried from beyond each node.
  void look(const Eigen::MatrixX3d& tangents, Place& place, Eigen::MatrixX3d& force) const;
  /// Adds the springs' second derivatives to `hessian`, except the part with second derivatives of
  /// the tangents, which the force from look() covers.
  /// @param tangents  derivatives of the tangents by the unknowns, one matrix per axis, nodes x
  ///   unknowns
  void add_hessian(const Place& place, const std::array<Eigen::MatrixXd, 3>& tangents,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;

  /// Adds the springs' second derivatives out of the plane of a planar span. @param angle  tilt of
  /// the tangents out of the plane by the unknowns, nodes x unknowns
  void add_tilt_hessian(const Place& place, const Eigen::MatrixXd& angle,
                        Eigen::MatrixXd& hessian) const;

  /// Returns the energy of the springs.
  [[nodiscard]] double energy(const Place& place) const;
  /// Returns the force of each obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> forces(const Place& place) const;
  /// Returns the moment of the obstacles' forces about the anchor.
  [[nodiscard]] Eigen::Vector3d moment(const Place& place, const Eigen::MatrixX3d& tangents) const;

 private:
  [[nodiscard]] Eigen::Vector3d push(std::size_t obstacle, const Pressed& at) const;

  std::vector<Span::SoftObstacle> obstacles_;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd position_;  // positions of the nodes by tangents at the nodes
};

}  // namespace dlo::energy_model
