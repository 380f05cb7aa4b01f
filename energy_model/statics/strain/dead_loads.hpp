#pragma once

#include <Eigen/Core>
#include <vector>

#include "frames/planar_frames.hpp"
#include "frames/position_operator.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Weight and dead loads of a span. Their energy is linear in the tangents t_q at the nodes and,
/// for a planar span with couples, in its unknowns x:
///     E = -sum_q force_q . t_q - couples . x   [EI/l].
class DeadLoads {
 public:
  /// Sets up the loads of a span. @param nodes  arc lengths of the quadrature nodes
  /// @param weights  quadrature weights
  void reset(const Span& span, const Eigen::VectorXd& nodes, const Eigen::VectorXd& weights);
  /// Computes the couples' coefficients; for a span in its plane.
  void tabulate_couples(const Span& span, const std::vector<Piece>& pieces,
                        const PlanarFrames& frames);

  /// Returns -dE/dt, nodes x 3: the node's quadrature weight times the load beyond it, as seen from
  /// the anchor.
  [[nodiscard]] const Eigen::MatrixX3d& force() const { return force_; }
  /// -dE/dx of the couples; empty if there are none.
  [[nodiscard]] const Eigen::VectorXd& couples() const { return couples_; }
  /// Returns the energy of weight and forces [EI/l]. @param tangents  nodes x 3
  [[nodiscard]] double force_energy(const Eigen::MatrixX3d& tangents) const {
    return -force_.cwiseProduct(tangents).sum();
  }
  /// Adds the loads' moment about the anchor.
  void add_moment(const Span& span, const Eigen::MatrixX3d& tangents,
                  Eigen::Vector3d& moment) const;

 private:
  Eigen::MatrixX3d force_;
  Eigen::VectorXd couples_;
};

/// Returns the energy of the loads' forces, without weight and couples [EI/l].
[[nodiscard]] double energy_of_forces(const std::vector<Span::Load>& loads,
                                      const PositionOperator& reach,
                                      const Eigen::MatrixX3d& tangents);

}  // namespace dlo::energy_model
