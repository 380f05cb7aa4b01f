// How cross-sections turn as the strains change.

#include "base/spin.hpp"
#include "linear/dense_products.hpp"
#include "strain/rod_frames.hpp"

namespace dlo::energy_model {

/// What the strains of a panel's nodes change by, along the directors there.
Eigen::MatrixX3d RodFrames::strains_in_space(const Panel& panel,
                                             const Eigen::Ref<const Eigen::VectorXd>& rates,
                                             const State& state) const {
  const Eigen::Index Q = panel.nodes();
  Eigen::MatrixX3d result = Eigen::MatrixX3d::Zero(Q, 3);
  for (Eigen::Index field = 0; field < fields_; ++field) {
    const Eigen::VectorXd strains = panel.strain[static_cast<std::size_t>(field)] *
                                    (panel.table->values.leftCols(panel.terms) *
                                     rates.segment(field * columns_ + panel.column, panel.terms));
    result += strains.asDiagonal() * director(state, field).middleRows(panel.node, Q);
  }
  return result;
}

FrameSpins RodFrames::spins(const Eigen::Ref<const Eigen::VectorXd>& v,
                            const Eigen::Ref<const Eigen::VectorXd>& a, const Eigen::Vector3d& spin,
                            const Eigen::Vector3d& spin_rate, const State& state) const {
  FrameSpins result{{}, {}, spin, spin_rate};
  result.velocities.resize(nodes_ - turn_nodes_, 3);
  result.accelerations.resize(nodes_ - turn_nodes_, 3);
  for (const Panel& panel : panels_) {
    const LegendreTable& table = *panel.table;
    const Eigen::MatrixX3d changed = strains_in_space(panel, v, state);
    Eigen::MatrixX3d velocities(panel.nodes(), 3);
    multiply(table.integration, changed, velocities);
    velocities = (panel.length * velocities).rowwise() + result.end_velocity.transpose();
    const Eigen::MatrixX3d changed_on =
        strains_in_space(panel, a, state) + cross_rows(velocities, changed);
    if (panel.node >= turn_nodes_) {
      auto accelerations = result.accelerations.middleRows(panel.node - turn_nodes_, panel.nodes());
      multiply(table.integration, changed_on, accelerations);
      accelerations =
          (panel.length * accelerations).rowwise() + result.end_acceleration.transpose();
      result.velocities.middleRows(panel.node - turn_nodes_, panel.nodes()) = velocities;
    }
    result.end_velocity += panel.length * (changed.transpose() * table.weights);
    result.end_acceleration += panel.length * (changed_on.transpose() * table.weights);
  }
  return result;
}

}  // namespace dlo::energy_model
