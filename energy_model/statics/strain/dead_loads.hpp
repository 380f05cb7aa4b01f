#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/planar_frames.hpp"
#include "frames/position_operator.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Weight and dead loads of a span, linear in its tangents t_q at the nodes and, of a planar one
/// with couples, in its unknowns x:
///     E = -sum_q force_q . t_q - couples . x   [EI/l].
class DeadLoads {
 public:
  /// @param nodes    arc lengths
  /// @param weights  of their quadrature
  void reset(const Span& span, const Eigen::VectorXd& nodes, const Eigen::VectorXd& weights);
  /// Of a span in its plane.
  void tabulate_couples(const Span& span, const std::vector<Piece>& pieces,
                        const PlanarFrames& frames);

  /// -dE/dt: quadrature weight of the node times what hangs beyond it, seen from the anchor, nodes
  /// x 3.
  [[nodiscard]] const Eigen::MatrixX3d& force() const { return force_; }
  /// -dE/dx of the couples; empty: there are none.
  [[nodiscard]] const Eigen::VectorXd& couples() const { return couples_; }
  /// Of weight and forces. @param tangents  nodes x 3
  [[nodiscard]] double force_energy(const Eigen::MatrixX3d& tangents) const {
    return -force_.cwiseProduct(tangents).sum();
  }
  /// Adds the moment about the anchor.
  void add_moment(const Span& span, const Eigen::MatrixX3d& tangents,
                  Eigen::Vector3d& moment) const;

 private:
  Eigen::MatrixX3d force_;
  Eigen::VectorXd couples_;
};

/// Energy of the loads' forces alone, without weight and couples [EI/l].
[[nodiscard]] double energy_of_forces(const std::vector<Span::Load>& loads,
                                      const PositionOperator& reach,
                                      const Eigen::MatrixX3d& tangents);

}  // namespace dlo::energy_model
