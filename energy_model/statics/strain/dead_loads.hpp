#pragma once

#include <Eigen/Core>

#include "strain/term.hpp"

namespace dlo::energy_model {

/// Weight and dead loads of a span. Their energy is linear in the tangents t_q at the nodes and,
/// for a planar span with couples, in its unknowns x:
///     E = -sum_q force_q . t_q - couples . x   [EI/l].
class DeadLoads : public Term {
 public:
  void reset(const TermSetup& setup);
  void evaluate(SpanPoint& at) const;
  void add_couples(Eigen::Vector3d& moment) const { moment.z() += couple_; }
  void add_energies(const TermSetup& setup, const SpanPoint& at, Energies& energies) const;
  /// Returns -dE/dt, nodes x 3: the node's quadrature weight times the load beyond it, as seen from
  /// the anchor; at nodes before the anchor with the opposite sign.
  [[nodiscard]] const Eigen::MatrixX3d& force() const { return force_; }

 private:
  Eigen::MatrixX3d force_;
  Eigen::VectorXd couples_;  // -dE/dx; empty: there are none
  double couple_ = 0;        // sum of the couples
};

}  // namespace dlo::energy_model
