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
  void reset(const Span& span, const std::vector<Piece>& pieces, const LegendreTable& table);

  [[nodiscard]] bool any() const { return !obstacles_.empty(); }

  /// Energy of the springs at these tangents (nodes x 3); adds what they push with, carried from
  /// beyond each node, to `force` (nodes x 3). Keeps the pressures.
  double add(const Eigen::MatrixX3d& tangents, Eigen::MatrixX3d& force);
  /// Adds the springs' second derivatives but for what bends the tangents twice, which is in the
  /// force that add() adds.
  /// @param tangents  derivatives of the tangents by the unknowns, an axis each, nodes x unknowns
  void add_hessian(const std::array<Eigen::MatrixXd, 3>& tangents,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;

  /// Adds what leaving the plane changes of a planar span. @param angle  nodes x unknowns: tilt of
  /// the tangents out of the plane
  void add_tilt_hessian(const Eigen::MatrixXd& angle, Eigen::MatrixXd& hessian) const;

  /// Of the springs at the point of the last add().
  [[nodiscard]] double energy() const;
  /// Force of each obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> forces() const;
  /// Their moment about the anchor.
  [[nodiscard]] Eigen::Vector3d moment(const Eigen::MatrixX3d& tangents) const;

 private:
  /// A node within an obstacle.
  struct Pressed {
    Eigen::Index node = 0;
    obstacle::Gap gap;
  };
  [[nodiscard]] Eigen::Vector3d push(std::size_t obstacle, const Pressed& at) const;

  std::vector<Span::SoftObstacle> obstacles_;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd position_;                   // of the nodes by tangent of the nodes
  std::vector<std::vector<Pressed>> pressed_;  // by obstacle, of the last add()
};

}  // namespace dlo::energy_model
