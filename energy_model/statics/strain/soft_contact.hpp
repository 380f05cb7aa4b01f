#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "strain/term.hpp"

namespace dlo::energy_model {

/// Whether a point in the plane z = 0 of a planar span is equally close to faces of the body on
/// both sides of the plane, about which the body is symmetric. The contact energy has a ridge
/// there.
[[nodiscard]] bool is_on_ridge(const obstacle::Gap& gap);

/// Contact of a span's quadrature nodes with its soft obstacles, which are one-sided springs: with
/// the clearance d of a node, the force p = max(0, -k d) and the energy p^2 / 2k per length.
class SoftContact : public Term {
 public:
  void reset(const TermSetup& setup);
  [[nodiscard]] bool is_curved() const { return !obstacles_.empty(); }
  void evaluate(SpanPoint& at) const;
  void add_hessian(const SpanPoint& at, const std::array<Eigen::MatrixXd, 3>& tangents,
                   Eigen::Ref<Eigen::MatrixXd> hessian) const;
  void add_energies(const TermSetup& setup, const SpanPoint& at, Energies& energies) const;
  /// Returns the force of each obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> forces(const SpanPoint& at) const;

 private:
  /// A node within an obstacle.
  struct PenetratingNode {
    std::size_t obstacle = 0;
    Eigen::Index node = 0;
    obstacle::Gap gap;
    double stiffness = 0;  // stiffness of the obstacle times the node's quadrature weight

    [[nodiscard]] double energy() const { return stiffness * gap.value * gap.value / 2; }
    [[nodiscard]] Eigen::Vector3d force() const { return -stiffness * gap.value * gap.gradient; }
  };
  [[nodiscard]] std::vector<PenetratingNode> penetrating_nodes(
      const Eigen::MatrixX3d& tangents) const;
  [[nodiscard]] Eigen::Matrix3d energy_hessian(const PenetratingNode& at) const;

  std::vector<Span::SoftObstacle> obstacles_;
  bool planar_ = true;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd position_;  // positions of the nodes by tangents at the nodes
};

}  // namespace dlo::energy_model
