#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/legendre.hpp"
#include "frames/span_shape.hpp"

namespace dlo::energy_model {

/// Whether a point in the plane z = 0 of a planar span, about which the body is symmetric, is as
/// near to a face on either side of it: its energy has a ridge there.
[[nodiscard]] bool is_on_ridge(const obstacle::Gap& gap);

/// Contact of a span's quadrature nodes with its soft obstacles, which are one-sided springs.
class SoftContact {
 public:
  /// A node within an obstacle.
  struct Pressed {
    Eigen::Index node = 0;
    obstacle::Gap gap;
  };
  /// At a point, by obstacle.
  using Place = std::vector<std::vector<Pressed>>;

  void reset(const Span& span, const std::vector<Piece>& pieces, const LegendreTable& table);

  [[nodiscard]] bool any() const { return !obstacles_.empty(); }

  /// What is pressed at these tangents (nodes x 3); adds what that pushes with, carried from beyond
  /// each node, to `force` (nodes x 3).
  void look(const Eigen::MatrixX3d& tangents, Place& place, Eigen::MatrixX3d& force) const;
  /// Adds the springs' second derivatives but for what bends the tangents twice, which is in the
  /// force that look() adds.
  /// @param tangents  derivatives of the tangents by the unknowns, an axis each, nodes x unknowns
  void add_hessian(const Place& place, const std::array<Eigen::MatrixXd, 3>& tangents,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;

  /// Adds what leaving the plane changes of a planar span. @param angle  nodes x unknowns: tilt of
  /// the tangents out of the plane
  void add_tilt_hessian(const Place& place, const Eigen::MatrixXd& angle,
                        Eigen::MatrixXd& hessian) const;

  /// Of the springs.
  [[nodiscard]] double energy(const Place& place) const;
  /// Force of each obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> forces(const Place& place) const;
  /// Their moment about the anchor.
  [[nodiscard]] Eigen::Vector3d moment(const Place& place, const Eigen::MatrixX3d& tangents) const;

 private:
  [[nodiscard]] Eigen::Vector3d push(std::size_t obstacle, const Pressed& at) const;

  std::vector<Span::SoftObstacle> obstacles_;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd position_;  // of the nodes by tangent of the nodes
};

}  // namespace dlo::energy_model
